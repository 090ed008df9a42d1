// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_reserve.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

enum { SIZE_LIMIT_BYTES = 8 * 1024 * 1024, SHARE_OF_DISK = 8 };

// Returns 0 or an errno. A new reserve leaves as much room beside it: the store would otherwise be full again at once.
static int fill_up(int fd)
{
    struct statvfs disk;
    struct stat status;
    uint64_t size_bytes;

    if (fstatvfs(fd, &disk) != 0 || fstat(fd, &status) != 0) return errno;
    size_bytes = (uint64_t)disk.f_blocks * disk.f_frsize / SHARE_OF_DISK;
    if (size_bytes > SIZE_LIMIT_BYTES) size_bytes = SIZE_LIMIT_BYTES;
    if (status.st_size == 0 && (uint64_t)disk.f_bavail * disk.f_frsize < 2 * size_bytes) return ENOSPC;
    return posix_fallocate(fd, 0, (off_t)size_bytes);
}

static bool lacks_room(int code)
{
    return code == ENOSPC || code == EDQUOT;
}

bool store_reserve_make(const char *folder, struct error *error)
{
    char *path = xasprintf("%s/reserve", folder);
    int fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    int code = fd < 0 ? errno : fill_up(fd);

    if (fd >= 0) close(fd);
    if (code != 0) {
        if (fd >= 0) unlink(path);
        error_set(error, "store: the disk of %s is full", folder);
    }
    free(path);
    return !lacks_room(code);
}

bool store_reserve_release(const char *folder)
{
    char *path = xasprintf("%s/reserve", folder);
    bool ok = unlink(path) == 0;

    free(path);
    return ok;
}
