// SPDX-License-Identifier: Apache-2.0
#include "worker/process/part_file.h"

#include "core/base/error.h"
#include "core/base/log.h"
#include "core/job/output_path.h"
#include "core/job/output_root.h"
#include "worker/audit/gate.h"
#include "worker/process/assignment.h"
#include "worker/process/old_parts.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int part_file_open_folder(const struct assignment_frame *frame, struct error *error)
{
    const struct held_job *job = frame->job;
    int folder_fd = output_root_open_folder(&job->job.output.path, job->root, job->root_id, false, error);

    if (folder_fd < 0) return folder_fd;
    // Checked here rather than after the frame is rendered.
    if (faccessat(folder_fd, ".", W_OK | X_OK, AT_EACCESS) < 0) {
        error_set_errno(error, errno, "cannot write to \"%s/%s\"", job->root, job->job.output.path.folder);
        close(folder_fd);
        return -1;
    }
    return folder_fd;
}

static bool is_regular(int fd)
{
    struct stat status;

    return fstat(fd, &status) == 0 && S_ISREG(status.st_mode);
}

enum part_file_existing part_file_find_existing(const struct assignment_frame *frame, const char *picture_hash,
                                                int folder_fd, struct gate_result *found, struct error *error)
{
    const struct job *job = &frame->job->job;
    enum part_file_existing existing = PART_FILE_RENDER;
    char name[OUTPUT_NAME_SIZE];
    struct error reason = {0};
    struct stat status;
    int fd;

    output_path_format_name(&job->output.path, frame->frame, name);
    if (frame->is_forced || job->output.existing == JOB_EXISTING_OVERWRITE ||
        fstatat(folder_fd, name, &status, AT_SYMLINK_NOFOLLOW) < 0)
        return PART_FILE_RENDER;
    if (job->output.existing == JOB_EXISTING_FAIL) {
        error_set(error, "%s exists, and the job's output.existing is \"fail\"", name);
        return PART_FILE_REFUSE;
    }
    fd = openat(folder_fd, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0 || !is_regular(fd))
        log_info("%s is no file of ours: rendered again", name);
    else if (gate_check(
                 &(struct gate_params){
                     .fd = fd, .job = job, .picture_hash = picture_hash, .frame = frame->frame, .accepts_missed = true},
                 found, &reason))
        existing = PART_FILE_SKIP;
    else if (job->quality.is_draft && found->facts.job_hash[0] && !found->facts.is_draft)
        existing = PART_FILE_REFUSE;
    else
        log_info("%s is rendered again: %s", name, reason.message);
    if (existing == PART_FILE_REFUSE)
        error_set(
            error,
            "%s is a frame of ours and no draft, which a draft does not replace; expected another output.path, or "
            "output.existing \"overwrite\"",
            name);
    if (fd >= 0) close(fd);
    return existing;
}

static struct output_part part_of(const struct assignment_frame *frame)
{
    return (struct output_part){.farm = frame->job->farm_id,
                                .job = frame->job->id,
                                .epoch = frame->job->epoch,
                                .frame = frame->frame,
                                .attempt = frame->attempt};
}

static void format_name(const struct assignment_frame *frame, char name[static OUTPUT_NAME_SIZE])
{
    const struct output_part part = part_of(frame);

    output_path_format_part(&frame->job->job.output.path, &part, name);
}

bool part_file_take_old(const struct assignment_frame *frame, const char *picture_hash, int folder_fd,
                        struct gate_result *found)
{
    const struct output_part own = part_of(frame);
    const struct old_parts_params params = {
        .job = &frame->job->job, .own = &own, .picture_hash = picture_hash, .folder_fd = folder_fd};

    return frame->job->has_old_parts && !frame->is_forced && old_parts_take(&frame->job->old_parts, &params, found);
}

int part_file_create(const struct assignment_frame *frame, int folder_fd, struct error *error)
{
    char name[OUTPUT_NAME_SIZE];
    int fd, errnum;

    format_name(frame, name);
    fd = openat(folder_fd, name, O_CREAT | O_EXCL | O_NOFOLLOW | O_RDWR | O_CLOEXEC, 0644);
    if (fd >= 0) return fd;
    errnum = errno;
    error_set_errno(error, errnum, "%s", name);
    errno = errnum;
    return -1;
}

void part_file_remove(const struct assignment_frame *frame, int folder_fd)
{
    char name[OUTPUT_NAME_SIZE];

    format_name(frame, name);
    if (unlinkat(folder_fd, name, 0) < 0) log_warn("%s: %s", name, strerrordesc_np(errno));
}
