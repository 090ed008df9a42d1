// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_lock.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <dirent.h>
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

enum { STEP_MS = 10 };

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

// True when the process has the file open, as far as the system lets us see.
static bool has_open(const char *pid, const struct stat *file)
{
    char path[288];
    struct dirent *entry;
    struct stat status;
    bool found = false;
    DIR *descriptors;
    int folder;

    snprintf(path, sizeof path, "/proc/%s/fd", pid);
    descriptors = opendir(path);
    folder = descriptors ? dirfd(descriptors) : -1;
    while (folder >= 0 && !found && (entry = readdir(descriptors)))
        found = entry->d_name[0] != '.' && fstatat(folder, entry->d_name, &status, 0) == 0 &&
                status.st_dev == file->st_dev && status.st_ino == file->st_ino;
    if (descriptors) closedir(descriptors);
    return found;
}

// Another process that has the lock's file open: `hinted` if it has, else any; 0: none is seen. A lock belongs to an
// open file, which a process shares with the children that it starts, until they execute another program.
static long find_holder(int fd, long hinted)
{
    struct dirent *entry;
    struct stat file;
    long holder = 0;
    DIR *processes;
    char text[24];

    snprintf(text, sizeof text, "%ld", hinted);
    if (fstat(fd, &file) != 0) return 0;
    if (hinted > 0 && hinted != getpid() && has_open(text, &file)) return hinted;
    processes = opendir("/proc");
    while (processes && holder == 0 && (entry = readdir(processes))) {
        long pid = strtol(entry->d_name, NULL, 10);

        if (pid > 0 && pid != getpid() && has_open(entry->d_name, &file)) holder = pid;
    }
    if (processes) closedir(processes);
    return holder;
}

// True when the daemon that took the lock may still run: it has the file open, or nobody is seen to.
static bool is_kept(int fd)
{
    long pid = read_pid(fd), holder;

    if (pid <= 0) return true;
    if (kill((pid_t)pid, 0) != 0 && errno == ESRCH) return false;
    holder = find_holder(fd, pid);
    return holder == 0 || holder == pid;
}

// Returns 0 or an errno. A worker that a killed daemon was starting shares its lock until it executes its program, so
// the lock of a dead process is waited for.
static int lock_file(int fd, int wait_ms)
{
    const struct timespec step = {.tv_nsec = STEP_MS * 1000L * 1000L};

    for (int waited_ms = 0; flock(fd, LOCK_EX | LOCK_NB) != 0; waited_ms += STEP_MS) {
        int code = errno;

        if (code != EWOULDBLOCK || waited_ms >= wait_ms || is_kept(fd)) return code;
        nanosleep(&step, NULL);
    }
    return 0;
}

static void set_taken_error(int fd, const char *folder, struct error *error)
{
    long pid = read_pid(fd), holder = find_holder(fd, pid);

    if (holder > 0 && holder != pid)
        error_set(error,
                  "process %ld keeps %s locked: a marchd (pid %ld) that was killed had started it; end it with "
                  "`kill %ld`",
                  holder, folder, pid, holder);
    else if (pid > 0)
        error_set(error, "another marchd (pid %ld) uses %s", pid, folder);
    else
        error_set(error, "another marchd uses %s", folder);
}

int store_lock_take(const char *folder, int wait_ms, struct error *error)
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
    code = lock_file(fd, wait_ms);
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
