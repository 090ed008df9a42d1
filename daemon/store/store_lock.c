// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_lock.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { STEP_MS = 10, STEP_LIMIT = 1000 };

static bool sync_parent(const char *folder)
{
    char *copy = xstrdup(folder);
    int fd = open(dirname(copy), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    bool ok = fd >= 0 && fsync(fd) == 0;

    if (fd >= 0) close(fd);
    free(copy);
    return ok;
}

static bool make_folder(const char *folder, struct error *error)
{
    struct stat status;

    if (mkdir(folder, 0700) == 0) {
        if (sync_parent(folder)) return true;
        error_set_errno(error, errno, "store: cannot sync the parent of %s", folder);
        return false;
    }
    if (errno != EEXIST) {
        error_set_errno(error, errno, "store: cannot make the folder %s", folder);
        return false;
    }
    if (stat(folder, &status) == 0 && S_ISDIR(status.st_mode)) return true;
    error_set(error, "store: %s is not a folder", folder);
    return false;
}

// The pid that the file names; 0: none.
static long read_pid(int fd)
{
    char text[32] = "";
    ssize_t length = pread(fd, text, sizeof text - 1, 0);

    return length > 0 ? strtol(text, NULL, 10) : 0;
}

static bool is_alive(long pid)
{
    return pid <= 0 || kill((pid_t)pid, 0) == 0 || errno != ESRCH;
}

// Returns 0 or an errno. A worker that a killed daemon was starting shares its lock until it executes its program, so
// the lock of a dead process is waited for.
static int lock_file(int fd)
{
    const struct timespec step = {.tv_nsec = STEP_MS * 1000L * 1000L};

    for (int steps = 0; flock(fd, LOCK_EX | LOCK_NB) != 0; steps++) {
        int code = errno;

        if (code != EWOULDBLOCK || steps == STEP_LIMIT || is_alive(read_pid(fd))) return code;
        nanosleep(&step, NULL);
    }
    return 0;
}

static void set_taken_error(int fd, const char *folder, struct error *error)
{
    long pid = read_pid(fd);

    if (pid > 0)
        error_set(error, "another marchd (pid %ld) uses %s", pid, folder);
    else
        error_set(error, "another marchd uses %s", folder);
}

int store_lock_take(const char *folder, struct error *error)
{
    char *path = NULL;
    int fd = -1, code;

    if (!make_folder(folder, error)) goto fail;
    path = xasprintf("%s/lock", folder);
    fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (fd < 0) {
        error_set_errno(error, errno, "store: cannot open %s", path);
        goto fail;
    }
    code = lock_file(fd);
    if (code != 0) {
        if (code == EWOULDBLOCK)
            set_taken_error(fd, folder, error);
        else
            error_set_errno(error, code, "store: cannot lock %s", path);
        goto fail;
    }
    // The lock holds without the pid, as on a full disk.
    if (ftruncate(fd, 0) == 0) dprintf(fd, "%ld\n", (long)getpid());
    free(path);
    return fd;
fail:
    if (fd >= 0) close(fd);
    free(path);
    return -1;
}
