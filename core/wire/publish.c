// SPDX-License-Identifier: Apache-2.0
#include "core/wire/publish.h"

#include "core/base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { AWAIT_MS = 20 };

static bool is_expected(const struct stat *status, const struct published_file *expected)
{
    return S_ISREG(status->st_mode) && (uint64_t)status->st_ino == expected->inode &&
           (uint64_t)status->st_size == expected->size_bytes;
}

static bool check_part(int folder_fd, const char *part, const struct published_file *expected, struct error *error)
{
    struct stat status;

    if (fstatat(folder_fd, part, &status, AT_SYMLINK_NOFOLLOW) < 0) {
        error_set_errno(error, errno, "cannot publish %s", part);
        return false;
    }
    if (is_expected(&status, expected)) return true;
    if (S_ISREG(status.st_mode))
        error_set(error, "%s: expected inode %" PRIu64 " of %" PRIu64 " bytes, got inode %" PRIu64 " of %" PRIu64, part,
                  expected->inode, expected->size_bytes, (uint64_t)status.st_ino, (uint64_t)status.st_size);
    else
        error_set(error, "%s: expected a file, got %s", part,
                  S_ISLNK(status.st_mode) ? "a symbolic link" : "something else");
    return false;
}

// The name must be free or a regular file: a link was put there for another purpose.
static bool check_name(int folder_fd, const char *name, struct error *error)
{
    struct stat status;

    if (fstatat(folder_fd, name, &status, AT_SYMLINK_NOFOLLOW) < 0) {
        if (errno == ENOENT) return true;
        error_set_errno(error, errno, "cannot publish as %s", name);
        return false;
    }
    if (S_ISREG(status.st_mode)) return true;
    error_set(error, "%s: expected a file or nothing, got %s", name,
              S_ISLNK(status.st_mode) ? "a symbolic link" : "something else");
    return false;
}

// Opening a file asks a network file system for its newest state, and a descriptor is asked rather than a name.
static bool is_seen(int folder_fd, const char *name, const struct published_file *expected)
{
    int fd = openat(folder_fd, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    struct stat status;
    bool ok = fd >= 0 && fstat(fd, &status) == 0 && is_expected(&status, expected);

    if (fd >= 0) close(fd);
    return ok;
}

void publish_await(int folder_fd, const char *part, const struct published_file *expected, int64_t limit_ms)
{
    const struct timespec pause = {.tv_nsec = AWAIT_MS * 1000 * 1000};

    for (int64_t waited_ms = 0; waited_ms < limit_ms && !is_seen(folder_fd, part, expected); waited_ms += AWAIT_MS)
        nanosleep(&pause, NULL);
}

bool publish_file(int folder_fd, const char *part, const char *name, const struct published_file *expected,
                  struct error *error)
{
    int errnum;

    if (!check_part(folder_fd, part, expected, error)) return false;
    if (!check_name(folder_fd, name, error)) return false;
    if (renameat(folder_fd, part, folder_fd, name) == 0) return true;
    errnum = errno;
    if (is_seen(folder_fd, name, expected)) return true;
    error_set_errno(error, errnum, "cannot rename %s to %s", part, name);
    return false;
}

bool publish_sync(int folder_fd, struct error *error)
{
    if (fsync(folder_fd) == 0) return true;
    error_set_errno(error, errno, "cannot sync the output folder");
    return false;
}

bool publish_check_found(int folder_fd, const char *name, const struct published_file *expected, struct error *error)
{
    int fd = openat(folder_fd, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    struct stat status;
    char hash[HASH_TEXT_SIZE];
    bool ok = false;

    if (fd < 0 || fstat(fd, &status) < 0) {
        error_set_errno(error, errno, "%s", name);
        goto out;
    }
    if (!S_ISREG(status.st_mode) || (uint64_t)status.st_size != expected->size_bytes) {
        error_set(error, "%s: expected a file of %" PRIu64 " bytes, got %s of %" PRIu64, name, expected->size_bytes,
                  S_ISREG(status.st_mode) ? "one" : "no file", (uint64_t)status.st_size);
        goto out;
    }
    if (!hash_file(fd, hash, NULL, error)) goto out;
    ok = strcmp(hash, expected->hash) == 0;
    if (!ok) error_set(error, "%s: expected a file with the hash %s, got %s", name, expected->hash, hash);
out:
    if (fd >= 0) close(fd);
    return ok;
}

// True when `name` is the expected file, byte for byte.
static bool holds(int folder_fd, const char *name, const struct published_file *expected)
{
    int fd = openat(folder_fd, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    struct stat status;
    char hash[HASH_TEXT_SIZE];
    bool ok = fd >= 0 && fstat(fd, &status) == 0 && is_expected(&status, expected) && hash_file(fd, hash, NULL, NULL) &&
              strcmp(hash, expected->hash) == 0;

    if (fd >= 0) close(fd);
    return ok;
}

enum publish_state publish_settle(int folder_fd, const char *part, const char *name,
                                  const struct published_file *expected)
{
    if (holds(folder_fd, name, expected)) return PUBLISH_DONE;
    return holds(folder_fd, part, expected) ? PUBLISH_PENDING : PUBLISH_LOST;
}
