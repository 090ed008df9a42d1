// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/root_look.h"

#include "core/job/output_root.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// The folders of jobs whose files are published tell a root of an older version, which has no marker, from the folder
// below its mount point.
static bool holds_its_folders(const struct root_look *look, int root_fd)
{
    for (size_t i = 0; i < look->folder_count; i++)
        if (faccessat(root_fd, *look->folders[i] ? look->folders[i] : ".", F_OK, 0) == 0) return true;
    return look->folder_count == 0;
}

// The marker that is read at the end counts: another farm may write one at the same moment.
static bool mark(struct root_look *look, int root_fd, struct error *error)
{
    char fresh[ROOT_MARKER_ID_SIZE];

    root_marker_make_id(fresh);
    if (!root_marker_add_root(root_fd, look->id[0] ? look->id : fresh, error)) return false;
    look->was_marked = true;
    return root_marker_read(root_fd, look->id, error) == ROOT_MARKER_VALID;
}

// A farm that may not write into the marker uses the root all the same.
static bool take(struct root_look *look, int root_fd, struct error *error)
{
    switch (root_marker_read(root_fd, look->id, error)) {
    case ROOT_MARKER_UNKNOWN:
        return false;
    case ROOT_MARKER_NONE:
        if (!holds_its_folders(look, root_fd)) {
            error_set(error, "holds no folder of its jobs (is its disk mounted?)");
            return false;
        }
        if (!mark(look, root_fd, error)) return false;
        break;
    case ROOT_MARKER_EMPTY:
        if (!mark(look, root_fd, error)) return false;
        break;
    case ROOT_MARKER_VALID:
        break;
    }
    (void)root_marker_add_farm(root_fd, look->farm, look->state_folder, NULL);
    return true;
}

// Fills an empty marker with the expected id. `error` is set only where that failed.
static void refill(struct root_look *look, struct error *error)
{
    int root_fd = open(look->path, O_PATH | O_DIRECTORY | O_CLOEXEC);
    char found[ROOT_MARKER_ID_SIZE];

    if (root_fd < 0) return;
    if (root_marker_read(root_fd, found, NULL) == ROOT_MARKER_EMPTY && root_marker_add_root(root_fd, look->id, error) &&
        root_marker_add_farm(root_fd, look->farm, look->state_folder, error))
        look->was_marked = true;
    close(root_fd);
}

static int open_unknown(struct root_look *look)
{
    int root_fd = output_root_open(look->path, NULL, &look->error);
    struct error cause = {0};

    if (root_fd < 0 || take(look, root_fd, &cause)) return root_fd;
    error_set(&look->error, "output root %s: %s", look->path, cause.message);
    look->id[0] = '\0';
    close(root_fd);
    return -1;
}

static int open_expected(struct root_look *look)
{
    int root_fd = output_root_open(look->path, look->id, &look->error);
    struct error cause = {0};

    if (root_fd >= 0) return root_fd;
    refill(look, &cause);
    root_fd = output_root_open(look->path, look->id, &look->error);
    if (root_fd < 0 && cause.message[0])
        error_set(&look->error, "output root %s has an empty marker: %s", look->path, cause.message);
    return root_fd;
}

static struct root_place find_place(int root_fd)
{
    struct root_place place = {0};
    struct statx status;

    if (statx(root_fd, "", AT_EMPTY_PATH, STATX_INO | STATX_MNT_ID, &status) == 0)
        place = (struct root_place){.device = (uint64_t)status.stx_dev_major << 32 | status.stx_dev_minor,
                                    .inode = status.stx_ino,
                                    .mount = status.stx_mnt_id};
    return place;
}

void root_look_run(struct root_look *look)
{
    int root_fd = look->id[0] ? open_expected(look) : open_unknown(look);

    look->is_there = root_fd >= 0;
    look->is_unknown = root_fd < 0 && error_is_shortage(errno);
    if (root_fd < 0) return;
    look->place = find_place(root_fd);
    close(root_fd);
}
