// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/vdb_convert.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <fnmatch.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const char program[] = "nanovdb_convert";
static const char pattern[] = "marchd-vdb-??????.nvdb";

// Exit statuses of a child that could not become the program. By the shells' convention no program returns them.
enum { EXIT_NOT_RUN = 126, EXIT_NOT_FOUND = 127 };

enum { POLL_MS = 5 };

// A temporary file is locked while the process that uses it lives.
static void remove_if_left_behind(int folder_fd, const char *name)
{
    int fd = openat(folder_fd, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    struct stat status;

    if (fd < 0) return;
    if (fstat(fd, &status) == 0 && S_ISREG(status.st_mode) && status.st_uid == geteuid() &&
        flock(fd, LOCK_EX | LOCK_NB) == 0)
        (void)unlinkat(folder_fd, name, 0);
    close(fd);
}

static void sweep(const char *folder)
{
    DIR *entries = opendir(folder);
    int fd = entries ? dirfd(entries) : -1;
    struct dirent *entry;

    if (!entries) return;
    while ((entry = readdir(entries)))
        if (fd >= 0 && fnmatch(pattern, entry->d_name, 0) == 0) remove_if_left_behind(fd, entry->d_name);
    closedir(entries);
}

// Makes a locked file; -1 on failure. The caller owns `*path`.
static int make_temporary(const char *folder, char **path, struct error *error)
{
    for (;;) {
        struct stat status;
        int fd;

        *path = xasprintf("%s/marchd-vdb-XXXXXX.nvdb", folder);
        fd = mkostemps(*path, (int)strlen(".nvdb"), O_CLOEXEC);
        if (fd < 0) {
            error_set_errno(error, errno, "cannot make %s", *path);
        } else if (flock(fd, LOCK_EX) < 0 || fstat(fd, &status) < 0) {
            error_set_errno(error, errno, "cannot lock %s", *path);
            (void)unlink(*path);
            close(fd);
            fd = -1;
        } else if (status.st_nlink == 0) { // another process swept it before the lock
            close(fd);
            free(*path);
            continue;
        }
        return fd;
    }
}

// Runs in the child between fork and exec, so nothing here may wait for another thread's lock.
static void become_converter(char *const arguments[], pid_t parent)
{
    int nowhere = open("/dev/null", O_RDWR);
    sigset_t none;

    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent || nowhere < 0) _exit(EXIT_NOT_RUN);
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    // Its output is dropped; only its exit status counts.
    for (int fd = 0; fd <= 2; ++fd)
        dup2(nowhere, fd);
    execvp(program, arguments);
    _exit(errno == ENOENT ? EXIT_NOT_FOUND : EXIT_NOT_RUN);
}

static bool wait_for(pid_t child, int limit_ms, int *status, struct error *error)
{
    double end_s = clock_now_s() + 1e-3 * limit_ms;
    bool was_killed = false;
    pid_t ended;

    while ((ended = waitpid(child, status, was_killed ? 0 : WNOHANG)) != child) {
        if (ended < 0 && errno != EINTR) {
            error_set_errno(error, errno, "cannot wait for %s", program);
            return false;
        }
        if (!was_killed && clock_now_s() >= end_s) {
            kill(child, SIGKILL);
            was_killed = true;
        }
        if (!was_killed) nanosleep(&(struct timespec){.tv_nsec = POLL_MS * 1000000L}, NULL);
    }
    if (was_killed) error_set(error, "%s had not ended after %.3g s", program, 1e-3 * limit_ms);
    return !was_killed;
}

static bool run(char *const arguments[], int limit_ms, struct error *error)
{
    pid_t parent = getpid(), child = fork();
    int status;

    if (child == 0) become_converter(arguments, parent);
    if (child < 0) {
        error_set_errno(error, errno, "cannot run %s", program);
        return false;
    }
    if (!wait_for(child, limit_ms, &status, error)) return false;
    if (WIFSIGNALED(status))
        error_set(error, "%s was ended by signal %d", program, WTERMSIG(status));
    else if (WEXITSTATUS(status) == EXIT_NOT_FOUND)
        error_set(error,
                  "a .vdb file is read through %s, which is not installed: install libnanovdb-tools, or convert "
                  "the file with `%s -z` elsewhere",
                  program, program);
    else if (WEXITSTATUS(status) == EXIT_NOT_RUN)
        error_set(error, "cannot run %s", program);
    else if (WEXITSTATUS(status) != 0)
        error_set(error, "%s failed with exit status %d: is it an OpenVDB file?", program, WEXITSTATUS(status));
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

int vdb_convert(const char *path, int limit_ms, struct error *error)
{
    const char *folder = getenv("TMPDIR");
    // "./" keeps a relative name that begins with a dash from being an option.
    char *source = xasprintf("%s%s", path[0] == '/' ? "" : "./", path), *made;
    char name[] = "nanovdb_convert", overwrite[] = "-f";
    int lock_fd, fd = -1;

    if (!folder || !*folder) folder = "/tmp";
    sweep(folder);
    lock_fd = make_temporary(folder, &made, error);
    if (lock_fd >= 0 && run((char *[]){name, overwrite, source, made, NULL}, limit_ms, error)) {
        fd = open(made, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
        if (fd < 0) error_set_errno(error, errno, "cannot open %s", made);
    }
    if (lock_fd >= 0) {
        (void)unlink(made);
        close(lock_fd);
    }
    free(source);
    free(made);
    return fd;
}
