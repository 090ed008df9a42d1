// SPDX-License-Identifier: Apache-2.0
#include "worker/sandbox/sandbox_scratch.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <fnmatch.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static const char pattern[] = "marchd-worker-??????";

// Removes the converter's files from the folder and closes `fd`.
static void empty(int fd)
{
    DIR *entries = fdopendir(fd);
    struct dirent *entry;

    if (!entries) {
        close(fd);
        return;
    }
    while ((entry = readdir(entries)))
        if (entry->d_type != DT_DIR) (void)unlinkat(fd, entry->d_name, 0);
    closedir(entries);
}

static void remove_if_left_behind(int folder_fd, const char *name)
{
    int fd = openat(folder_fd, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    struct stat status;

    if (fd < 0) return;
    if (fstat(fd, &status) < 0 || status.st_uid != geteuid() || flock(fd, LOCK_EX | LOCK_NB) < 0) {
        close(fd);
        return;
    }
    empty(fd);
    (void)unlinkat(folder_fd, name, AT_REMOVEDIR);
}

static const char *temporary_folder(void)
{
    const char *folder = getenv("TMPDIR");

    return folder && *folder ? folder : "/tmp";
}

void sandbox_scratch_sweep(void)
{
    DIR *entries = opendir(temporary_folder());
    int fd = entries ? dirfd(entries) : -1;
    struct dirent *entry;

    if (!entries) return;
    while ((entry = readdir(entries)))
        if (fd >= 0 && fnmatch(pattern, entry->d_name, 0) == 0) remove_if_left_behind(fd, entry->d_name);
    closedir(entries);
}

int sandbox_scratch_make(struct error *error)
{
    for (;;) {
        char *path = xasprintf("%s/marchd-worker-XXXXXX", temporary_folder());
        struct stat status;
        int fd;

        if (!mkdtemp(path)) {
            error_set_errno(error, errno, "cannot make %s", path);
            free(path);
            return -1;
        }
        fd = open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
        // Otherwise another process swept it before the lock.
        if (fd >= 0 && flock(fd, LOCK_EX) == 0 && fstat(fd, &status) == 0 && status.st_nlink > 0) {
            setenv("TMPDIR", path, 1);
            free(path);
            return fd;
        }
        if (fd >= 0) close(fd);
        free(path);
    }
}
