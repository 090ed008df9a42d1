// SPDX-License-Identifier: Apache-2.0
#include "worker/sandbox/sandbox_folders.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/input_roots.h"
#include "core/job/output_path.h"
#include "core/job/output_root.h"
#include "core/job/root_marker.h"
#include "core/scene/input_path.h"
#include "worker/sandbox/fence.h"
#include "worker/sandbox/sandbox_landlock.h"

#include <dirent.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/openat2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

// Finds the real path of the descriptor's file or folder; false when the kernel does not tell.
static bool find_real_path(int fd, char path[static PATH_MAX])
{
    char link[64];
    ssize_t length;

    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    length = readlink(link, path, PATH_MAX - 1);
    if (length <= 0) return false;
    path[length] = '\0';
    return true;
}

static bool is_in(const char *path, const char *folder)
{
    size_t length = strlen(folder);

    if (strcmp(folder, "/") == 0) return true;
    return strncmp(path, folder, length) == 0 && (path[length] == '/' || path[length] == '\0');
}

// Returns the closed path inside the folder; NULL: none. A closed path that does not exist is compared as text.
static const char *find_closed_in(const struct fence *fence, int folder_fd)
{
    char folder[PATH_MAX], real[PATH_MAX];

    if (!find_real_path(folder_fd, folder)) return fence->closed.count > 0 ? fence->closed.paths[0] : NULL;
    for (size_t i = 0; i < fence->closed.count; i++)
        if (is_in(realpath(fence->closed.paths[i], real) ? real : fence->closed.paths[i], folder))
            return fence->closed.paths[i];
    return NULL;
}

// Returns true when the descriptor's file or folder is inside a closed path.
static bool is_closed(const struct fence *fence, int fd)
{
    char path[PATH_MAX], real[PATH_MAX];

    if (!find_real_path(fd, path)) return fence->closed.count > 0;
    for (size_t i = 0; i < fence->closed.count; i++)
        if (is_in(path, realpath(fence->closed.paths[i], real) ? real : fence->closed.paths[i])) return true;
    return false;
}

static bool is_root_itself(const struct fence_input *input, int folder_fd)
{
    struct stat root, folder;

    return stat(input->root, &root) == 0 && fstat(folder_fd, &folder) == 0 && root.st_ino == folder.st_ino &&
           root.st_dev == folder.st_dev;
}

// Matches "smoke.####.nvdb" with names that have digits instead of the signs, at least as many.
static bool has_name_of(const char *name, const char *pattern)
{
    size_t before = strcspn(pattern, "#"), signs = strspn(pattern + before, "#");
    size_t digits;

    if (signs == 0) return strcmp(name, pattern) == 0;
    if (strncmp(name, pattern, before) != 0) return false;
    digits = strspn(name + before, "0123456789");
    for (; digits >= signs; digits--)
        if (strcmp(name + before + digits, pattern + before + signs) == 0) return true;
    return false;
}

// Allows a file, or what a link leads to if that is below the root. A link that leads elsewhere, or to a closed path,
// is not allowed, so opening it fails later.
static bool allow_file(const struct sandbox_landlock *landlock, const struct fence *fence,
                       const struct fence_input *input, const char *name, struct error *error)
{
    const char *root = strcmp(input->root, "/") == 0 ? "" : input->root;
    struct open_how how = {.flags = O_PATH | O_CLOEXEC, .resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS};
    int root_fd = open(input->root, O_PATH | O_DIRECTORY | O_CLOEXEC), fd = -1;
    char *path = xasprintf("%s%s%s", input->folder, *input->folder ? "/" : "", name);
    struct stat status;
    bool ok = true;

    if (root_fd >= 0 && *root) fd = (int)syscall(SYS_openat2, root_fd, path, &how, sizeof how);
    if (root_fd >= 0 && !*root) fd = openat(root_fd, path, O_PATH | O_CLOEXEC);
    if (fd >= 0 && fstat(fd, &status) == 0 && S_ISREG(status.st_mode) && !is_closed(fence, fd))
        ok = sandbox_landlock_allow(landlock, fd, SANDBOX_READ, error);
    if (fd >= 0) close(fd);
    if (root_fd >= 0) close(root_fd);
    free(path);
    return ok;
}

// `folder_fd` is the input's folder. With `links_only` a rule about the folder covers the files that are no links.
static bool allow_files(const struct sandbox_landlock *landlock, const struct fence *fence,
                        const struct fence_input *input, int folder_fd, bool links_only, size_t *files_left,
                        struct error *error)
{
    int fd = openat(folder_fd, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *entries = fd >= 0 ? fdopendir(fd) : NULL;
    const char *pattern = strrchr(input->path, '/') + 1;
    struct dirent *entry;
    bool ok = true;

    // A folder may be searchable but not readable. Then only the file with the input's own name is allowed.
    if (!entries) return input_path_is_sequence(pattern) || allow_file(landlock, fence, input, pattern, error);
    while (ok && (entry = readdir(entries))) {
        if ((links_only && entry->d_type == DT_REG) || !has_name_of(entry->d_name, pattern)) continue;
        ok = *files_left > 0 && allow_file(landlock, fence, input, entry->d_name, error);
        if (*files_left == 0)
            error_set(error, "%s: expected at most %d files that are links, or in no folder of their own", input->place,
                      SANDBOX_FILE_LIMIT);
        else
            --*files_left;
    }
    closedir(entries);
    return ok;
}

bool sandbox_folders_allow_input(const struct sandbox_landlock *landlock, const struct fence *fence,
                                 const struct fence_input *input, size_t *files_left, struct error *error)
{
    struct job_input checked = {.path = input->path, .root = input->root, .folder = input->folder};
    int fd = -1;
    bool ok = false, is_open;

    snprintf(checked.place, sizeof checked.place, "%s", input->place);
    if (input_roots_check_opening(&checked, error) != 0) return false;
    fd = input_roots_open_folder(input->root, input->folder, error);
    if (fd < 0) return false;
    is_open = !is_root_itself(input, fd) && !find_closed_in(fence, fd) && !is_closed(fence, fd);
    ok = (!is_open || sandbox_landlock_allow(landlock, fd, SANDBOX_READ, error)) &&
         allow_files(landlock, fence, input, fd, is_open, files_left, error);
    close(fd);
    return ok;
}

// A root that is not checked may have no marker.
static bool allow_marker(const struct sandbox_landlock *landlock, int root_fd, struct error *error)
{
    int fd = openat(root_fd, ROOT_MARKER_NAME, O_PATH | O_NOFOLLOW | O_CLOEXEC);
    bool ok = fd < 0 || sandbox_landlock_allow(landlock, fd, SANDBOX_READ, error);

    if (fd >= 0) close(fd);
    return ok;
}

bool sandbox_folders_allow_output(const struct sandbox_landlock *landlock, const struct fence *fence,
                                  const struct fence_job *job, bool *is_root_away, struct error *error)
{
    const struct output_path path = {.folder = job->output_folder};
    int root_fd = output_root_open(job->output_root, job->root_id, error), fd = -1;
    const char *closed;
    bool ok = false;

    if (is_root_away) *is_root_away = root_fd < 0;
    if (root_fd < 0) return false;
    fd = output_path_open_below(&path, root_fd, job->output_root, false, error);
    if (fd < 0) goto out;
    closed = find_closed_in(fence, fd);
    if (closed)
        error_set(error, "\"%s\" below \"%s\" holds %s, which is the daemon's: expected a folder beside it",
                  job->output_folder, job->output_root, closed);
    else
        ok = sandbox_landlock_allow(landlock, fd, SANDBOX_READ | SANDBOX_WRITE, error) &&
             allow_marker(landlock, root_fd, error);
out:
    if (fd >= 0) close(fd);
    close(root_fd);
    return ok;
}
