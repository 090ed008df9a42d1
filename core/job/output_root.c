// SPDX-License-Identifier: Apache-2.0
#include "core/job/output_root.h"

#include "core/base/error.h"
#include "core/job/output_path.h"
#include "core/job/root_marker.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool check_marker(int root_fd, const char *id, struct error *error)
{
    char found[ROOT_MARKER_ID_SIZE];

    switch (root_marker_read(root_fd, found, error)) {
    case ROOT_MARKER_VALID:
        if (strcmp(found, id) == 0) return true;
        error_set(error, "is another one: its " ROOT_MARKER_NAME " says %.8s, expected %.8s", found, id);
        return false;
    case ROOT_MARKER_EMPTY:
        error_set(error, "has an empty " ROOT_MARKER_NAME);
        return false;
    case ROOT_MARKER_NONE:
        error_set(error, "is not the folder that it was, it has no " ROOT_MARKER_NAME " (is its disk mounted?)");
        return false;
    case ROOT_MARKER_UNKNOWN:
        break;
    }
    return false;
}

int output_root_open(const char *root, const char *id, struct error *error)
{
    int root_fd = open(root, O_PATH | O_DIRECTORY | O_CLOEXEC);
    struct error cause = {0};
    int errnum = errno;

    if (root_fd < 0) {
        error_set_errno(error, errnum, "output root %s %s", root,
                        error_is_shortage(errnum) ? "cannot be opened" : "is not there");
        errno = errnum;
        return OUTPUT_ROOT_AWAY;
    }
    errno = 0;
    if (!id || check_marker(root_fd, id, &cause)) return root_fd;
    errnum = errno;
    error_set(error, "output root %s %s", root, cause.message);
    close(root_fd);
    errno = errnum;
    return OUTPUT_ROOT_AWAY;
}

int output_root_open_folder(const struct output_path *path, const char *root, const char *id, bool create,
                            struct error *error)
{
    int root_fd = output_root_open(root, id, error), fd, errnum;

    if (root_fd < 0) return root_fd;
    fd = output_path_open_below(path, root_fd, root, create, error);
    errnum = errno;
    close(root_fd);
    errno = errnum;
    return fd;
}

bool output_root_is_at(int root_fd, const char *root)
{
    struct stat opened, found;

    return fstat(root_fd, &opened) == 0 && stat(root, &found) == 0 && opened.st_dev == found.st_dev &&
           opened.st_ino == found.st_ino;
}
