// SPDX-License-Identifier: Apache-2.0
#include "worker/process/old_parts.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/job/job.h"
#include "worker/audit/gate.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

void old_parts_finish(struct old_parts *parts)
{
    free(parts->list);
    *parts = (struct old_parts){0};
}

// The folder is read once for all frames of the job.
static void list(struct old_parts *parts, const struct old_parts_params *params)
{
    int fd = openat(params->folder_fd, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *entries = fd >= 0 ? fdopendir(fd) : NULL;
    struct dirent *entry;

    parts->is_listed = true;
    while (entries && (entry = readdir(entries))) {
        struct output_part part;

        if (!output_path_read_part(&params->job->output.path, params->own->farm, entry->d_name, &part) ||
            part.job != params->own->job || part.epoch >= params->own->epoch)
            continue;
        parts->list = xgrow(parts->list, &parts->capacity, parts->count + 1, sizeof part);
        parts->list[parts->count++] = part;
    }
    if (entries)
        closedir(entries);
    else if (fd >= 0)
        close(fd);
}

static bool is_good(int fd, const struct old_parts_params *params, struct gate_result *found, struct error *error)
{
    const struct gate_params gate = {.fd = fd,
                                     .job = params->job,
                                     .picture_hash = params->picture_hash,
                                     .frame = params->own->frame,
                                     .accepts_missed = true};
    struct stat status;

    if (fstat(fd, &status) == 0 && S_ISREG(status.st_mode)) return gate_check(&gate, found, error);
    error_set(error, "it is no file");
    return false;
}

static bool take(const struct output_part *part, const struct old_parts_params *params, struct gate_result *found)
{
    char old_name[OUTPUT_NAME_SIZE], name[OUTPUT_NAME_SIZE];
    struct error reason = {0};
    bool ok;
    int fd;

    output_path_format_part(&params->job->output.path, part, old_name);
    output_path_format_part(&params->job->output.path, params->own, name);
    fd = openat(params->folder_fd, old_name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) return false;
    ok = is_good(fd, params, found, &reason);
    if (ok && (fsync(fd) != 0 || renameat(params->folder_fd, old_name, params->folder_fd, name) != 0)) {
        error_set(&reason, "it cannot be synced and renamed");
        ok = false;
    }
    if (ok)
        log_info("%s is of an earlier start, and whole: its frame is not rendered again", old_name);
    else
        log_info("%s is of an earlier start: its frame is rendered again: %s", old_name, reason.message);
    close(fd);
    return ok;
}

bool old_parts_take(struct old_parts *parts, const struct old_parts_params *params, struct gate_result *found)
{
    bool ok = false;

    if (!parts->is_listed) list(parts, params);
    for (size_t i = 0; i < parts->count && !ok; i++)
        ok = parts->list[i].frame == params->own->frame && take(&parts->list[i], params, found);
    return ok;
}
