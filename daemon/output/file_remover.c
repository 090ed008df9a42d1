// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/file_remover.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/frame_range.h"
#include "core/job/output_path.h"
#include "core/job/output_root.h"
#include "core/wire/publish.h"
#include "daemon/schedule/queue.h"
#include "daemon/store/store_reader.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct removal {
    struct file_remover *remover;
    int folder_fd; // -1: the folder is gone
    bool *is_told; // owned; of each frame: its row says what its file is
};

// Compares inode, size and time: the file of a later job may have got the same inode.
static bool is_published(const struct stat *status, const struct store_frame *row, int64_t finished_ms)
{
    int64_t written_ms = (int64_t)status->st_mtim.tv_sec * 1000 + status->st_mtim.tv_nsec / 1000000;

    return S_ISREG(status->st_mode) && (uint64_t)status->st_ino == row->inode &&
           (uint64_t)status->st_size == row->size_bytes && written_ms <= finished_ms;
}

static bool on_row(void *user, const struct store_frame *row, struct error *error)
{
    struct removal *removal = user;
    struct file_remover *remover = removal->remover;
    char name[OUTPUT_NAME_SIZE];
    struct stat status;

    if (row->index >= frame_range_count(remover->frames)) return true;
    removal->is_told[row->index] = row->state == FRAME_SUCCEEDED || row->state == FRAME_SKIPPED;
    if (row->state != FRAME_SUCCEEDED) return true;
    output_path_format_name(remover->path, frame_range_at(remover->frames, row->index), name);
    if (removal->folder_fd < 0 || fstatat(removal->folder_fd, name, &status, AT_SYMLINK_NOFOLLOW) < 0) {
        remover->missing++;
        return true;
    }
    if (!is_published(&status, row, remover->finished_ms)) {
        remover->kept++;
        return true;
    }
    if (unlinkat(removal->folder_fd, name, 0) < 0 && errno != ENOENT) {
        error_set_errno(error, errno, "cannot remove %s", name);
        return false;
    }
    remover->removed++;
    remover->removed_bytes += status.st_size;
    return true;
}

// A frame that was retried and then canceled, or failed, has its older file still, which no row describes.
static void count_others(const struct removal *removal)
{
    struct file_remover *remover = removal->remover;
    int64_t count = removal->folder_fd < 0 ? 0 : frame_range_count(remover->frames);
    char name[OUTPUT_NAME_SIZE];

    for (int64_t i = 0; i < count; i++) {
        if (removal->is_told[i]) continue;
        output_path_format_name(remover->path, frame_range_at(remover->frames, i), name);
        remover->kept += faccessat(removal->folder_fd, name, F_OK, AT_SYMLINK_NOFOLLOW) == 0;
    }
}

static bool remove_files(struct file_remover *remover, int folder_fd, struct error *error)
{
    struct store_reader *reader = store_reader_open(remover->state_folder, error);
    struct removal removal = {remover, folder_fd,
                              xcalloc((size_t)frame_range_count(remover->frames) + 1, sizeof(bool))};
    bool ok = reader && store_read_frames(reader, remover->job, 0, INT32_MAX, on_row, &removal, error);

    if (ok) count_others(&removal);
    free(removal.is_told);
    store_reader_close(reader);
    return ok && (folder_fd < 0 || publish_sync(folder_fd, error));
}

// Removes the folder when it is empty; the root itself stays.
static void remove_folder(const struct file_remover *remover)
{
    const char *folder = remover->path->folder, *slash = strrchr(folder, '/');
    struct output_path parent = *remover->path;
    int parent_fd;

    if (!*folder) return;
    parent.folder = slash ? xstrndup(folder, (size_t)(slash - folder)) : xstrdup("");
    parent_fd = output_root_open_folder(&parent, remover->root, remover->root_id, false, NULL);
    free(parent.folder);
    if (parent_fd < 0) return;
    if (unlinkat(parent_fd, slash ? slash + 1 : folder, AT_REMOVEDIR) == 0) publish_sync(parent_fd, NULL);
    close(parent_fd);
}

bool file_remover_run(struct file_remover *remover, struct error *error)
{
    int folder_fd = output_root_open_folder(remover->path, remover->root, remover->root_id, false, error);
    bool is_gone = folder_fd == -1 && errno == ENOENT;
    bool ok;

    if (folder_fd < 0 && !is_gone) return false;
    ok = remove_files(remover, folder_fd, error);
    if (is_gone) return ok;
    close(folder_fd);
    if (ok && remover->may_remove_folder) remove_folder(remover);
    return ok;
}
