// SPDX-License-Identifier: Apache-2.0
#include "core/base/file.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

static ssize_t read_some(int fd, void *bytes, size_t size_bytes)
{
    ssize_t count;

    do
        count = read(fd, bytes, size_bytes);
    while (count < 0 && errno == EINTR);
    return count;
}

// Reads `fd` to its end; its size need not be known beforehand.
static bool read_to_end(int fd, size_t limit_bytes, char **text, size_t *length, struct error *error)
{
    size_t capacity = 0;

    for (;;) {
        ssize_t count;

        *text = xgrow(*text, &capacity, *length + 4096, 1);
        count = read_some(fd, *text + *length, capacity - *length - 1);
        if (count < 0) {
            error_set_errno(error, errno, "cannot read");
            return false;
        }
        *length += (size_t)count;
        (*text)[*length] = '\0';
        if (count == 0) return true;
        if (*length > limit_bytes) {
            error_set(error, "larger than the %zu bytes allowed", limit_bytes);
            return false;
        }
    }
}

bool file_read_text(const char *path, size_t limit_bytes, char **text, size_t *length, struct error *error)
{
    bool ok = false;
    size_t size = 0;
    struct stat status;
    int fd = open(path, O_RDONLY | O_CLOEXEC);

    *text = NULL;
    if (fd < 0 || fstat(fd, &status) < 0) {
        error_set_errno(error, errno, "cannot open");
        goto out;
    }
    if (S_ISREG(status.st_mode) && (uint64_t)status.st_size > limit_bytes) {
        error_set(error, "%" PRId64 " bytes are more than the %zu allowed", (int64_t)status.st_size, limit_bytes);
        goto out;
    }
    ok = read_to_end(fd, limit_bytes, text, &size, error);
out:
    if (fd >= 0) close(fd);
    if (!ok) {
        free(*text);
        *text = NULL;
        size = 0;
    }
    if (length) *length = size;
    return ok;
}

bool file_write_all(int fd, const void *bytes, size_t size_bytes, struct error *error)
{
    size_t done = 0;

    while (done < size_bytes) {
        ssize_t count = write(fd, (const char *)bytes + done, size_bytes - done);

        if (count < 0 && errno == EINTR) continue;
        if (count < 0) {
            error_set_errno(error, errno, "cannot write");
            return false;
        }
        done += (size_t)count;
    }
    return true;
}

static bool sync_folder_of(const char *path, struct error *error)
{
    const char *slash = strrchr(path, '/');
    char *folder = slash ? xstrndup(path, slash == path ? 1 : (size_t)(slash - path)) : xstrdup(".");
    int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    bool ok = fd >= 0 && fsync(fd) == 0;

    if (!ok) error_set_errno(error, errno, "cannot sync its folder");
    if (fd >= 0) close(fd);
    free(folder);
    return ok;
}

// A name beside `path` that nobody else takes; owned by the caller.
static char *name_beside(const char *path)
{
    uint64_t number = 0;

    if (getrandom(&number, sizeof number, 0) != (ssize_t)sizeof number) number = (uint64_t)getpid();
    return xasprintf("%s.%016" PRIx64 ".tmp", path, number);
}

static bool replace(const char *path, const void *bytes, size_t size_bytes, bool is_synced, struct error *error)
{
    bool ok = false;
    char *beside = name_beside(path);
    int fd = open(beside, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);

    if (fd < 0) {
        error_set_errno(error, errno, "cannot create %s", beside);
        goto out;
    }
    if (!file_write_all(fd, bytes, size_bytes, error)) goto out;
    if (is_synced && fsync(fd) < 0) {
        error_set_errno(error, errno, "cannot sync");
        goto out;
    }
    if (rename(beside, path) < 0) {
        error_set_errno(error, errno, "cannot rename %s", beside);
        goto out;
    }
    ok = true;
out:
    if (fd >= 0) {
        close(fd);
        if (!ok) unlink(beside);
    }
    free(beside);
    return ok;
}

bool file_write_atomic(const char *path, const void *bytes, size_t size_bytes, struct error *error)
{
    return replace(path, bytes, size_bytes, true, error) && sync_folder_of(path, error);
}

bool file_replace(const char *path, const void *bytes, size_t size_bytes, struct error *error)
{
    return replace(path, bytes, size_bytes, false, error);
}
