// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/nanovdb_load.h"

#include "core/base/error.h"
#include "worker/sparse/vdb_convert.h"
#include "worker/volume/volume_memory.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static bool read_all(int fd, char *bytes, size_t size_bytes, struct error *error)
{
    for (size_t done = 0; done < size_bytes;) {
        ssize_t count = read(fd, bytes + done, size_bytes - done);

        if (count < 0 && errno == EINTR) continue;
        if (count < 0) error_set_errno(error, errno, "cannot read");
        if (count == 0) error_set(error, "it ended after %zu of %zu bytes", done, size_bytes);
        if (count <= 0) return false;
        done += (size_t)count;
    }
    return true;
}

// Closes `fd`, which may be -1 after an error. The caller frees the bytes; `file` is empty on failure.
static bool read_file(int fd, struct nanovdb_bytes *file, struct error *error)
{
    struct stat status;
    char *bytes = NULL;
    bool ok = false;

    *file = (struct nanovdb_bytes){0};
    if (fd < 0) return false;
    if (fstat(fd, &status) < 0) {
        error_set_errno(error, errno, "cannot open");
        goto out;
    }
    if (!S_ISREG(status.st_mode)) {
        error_set(error, "expected a file, got %s", S_ISDIR(status.st_mode) ? "a folder" : "a pipe or a device");
        goto out;
    }
    if (!volume_memory_check(status.st_size, volume_memory_limit(), error)) goto out;
    bytes = malloc(status.st_size > 0 ? (size_t)status.st_size : 1);
    if (!bytes) {
        error_set(error, "out of memory for its %" PRId64 " bytes", (int64_t)status.st_size);
        goto out;
    }
    ok = read_all(fd, bytes, (size_t)status.st_size, error);
    if (ok) *file = (struct nanovdb_bytes){bytes, (size_t)status.st_size};
out:
    close(fd);
    if (!ok) free(bytes);
    return ok;
}

static int open_file(const char *path, struct error *error)
{
    // Without O_NONBLOCK opening a FIFO would wait for its writer.
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);

    if (fd < 0) error_set_errno(error, errno, "cannot open");
    return fd;
}

bool nanovdb_load(struct nanovdb_bytes *file, const char *path, struct error *error)
{
    return read_file(open_file(path, error), file, error);
}

bool nanovdb_load_converted(struct nanovdb_bytes *file, const char *path, struct error *error)
{
    return read_file(vdb_convert(path, VDB_CONVERT_LIMIT_MS, error), file, error);
}
