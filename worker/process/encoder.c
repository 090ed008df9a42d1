// SPDX-License-Identifier: Apache-2.0
#include "worker/process/encoder.h"

#include "core/base/clock.h"
#include "core/base/error.h"
#include "worker/audit/gate.h"
#include "worker/picture/audit_result.h"
#include "worker/picture/image_exr.h"
#include "worker/process/options.h"
#include "worker/process/part_file.h"
#include "worker/process/report.h"
#include "worker/process/worker.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static struct image_exr_header make_header(const struct worker *worker, const struct picture *picture, const char *tags)
{
    const struct assignment_frame *frame = picture->frame;
    const struct job *job = &frame->job->job;
    struct image_exr_header header = {
        .pixel = job->output.pixel,
        .compression = job->output.compression,
        .fps_numerator = job->fps_numerator,
        .fps_denominator = job->fps_denominator,
        .owner = frame->job->owner,
        .host = worker->host,
        .node = frame->job->node,
        .farm = frame->job->farm_id,
        .job_name = job->name,
        .comment = job->notes.comment,
        .tags = tags,
        .job_id = frame->job->id,
        .job_hash = picture->hash,
        .sequence_hash = job->hash,
        .frame = frame->frame,
        .attempt = frame->attempt,
        .method = job_method_name(picture->method),
        .step = picture->step,
        .orders = job->scene.orders,
        .paths = picture->paths,
        .backend = worker->backend,
        .renderer = worker->renderer,
        .shader_hash = picture->shader_hash,
        .render_seconds = picture->render_s,
        .rays = {.is_known = picture->ray_counts.is_known,
                 .rays_per_pixel = picture->ray_counts.rays,
                 .cut_rays = picture->ray_counts.cut_rays,
                 .cut_share = picture->ray_counts.cut_share,
                 .cut_tolerance = job->quality.max_cut},
        .traced = picture->traced,
        .audit = picture->audit,
        .sampling_error = picture->sampling_error,
        .beyond = picture->beyond,
        .plan = picture->plan,
        .plan_number = picture->plan_number,
        .quality = picture->quality,
        .is_draft = job->quality.is_draft,
        .captured = (int64_t)time(NULL),
        .is_checked = true,
    };

    memcpy(header.world_to_camera, picture->world_to_camera, sizeof header.world_to_camera);
    memcpy(header.world_to_ndc, picture->world_to_ndc, sizeof header.world_to_ndc);
    return header;
}

static bool is_finite(const struct picture *picture, struct error *error)
{
    return image_is_finite(&picture->image, picture->frame->job->job.output.pixel == JOB_PIXEL_HALF, error);
}

// Writing checks each line while it packs it. Only a picture that it refuses is read again, to say which value is bad.
static bool write_file(const struct worker *worker, const struct picture *picture, int fd, enum report_fault *fault,
                       struct error *error)
{
    char *tags = job_notes_format_tags(&picture->frame->job->job.notes);
    const struct image_exr_header header = make_header(worker, picture, tags);
    bool ok = image_exr_write(fd, &picture->image, &header, worker->options->encode_threads, error);
    int reason = errno;

    free(tags);
    errno = reason;
    if (ok) return true;
    *fault = errno == 0 ? REPORT_FAULT_FRAME : REPORT_FAULT_OUTPUT;
    if (errno != 0 || is_finite(picture, error)) error_prefix(error, "cannot write the frame's file");
    return false;
}

// Writes the part file and gates it. On failure no file is left.
static bool write_part(struct worker *worker, const struct picture *picture, struct gate_result *result,
                       enum report_fault *fault, struct error *error)
{
    int fd = part_file_create(picture->frame, picture->folder_fd, error);
    bool ok;

    *fault = REPORT_FAULT_OUTPUT;
    if (fd < 0) {
        // The name is this attempt's own: another attempt has another name, so it is the frame that fails, not the
        // output.
        if (errno == EEXIST) *fault = REPORT_FAULT_FRAME;
        return false;
    }
    ok = write_file(worker, picture, fd, fault, error);
    worker_advance(worker);
    if (ok) {
        *fault = REPORT_FAULT_FRAME;
        ok = gate_check(&(struct gate_params){.fd = fd,
                                              .job = &picture->frame->job->job,
                                              .picture_hash = picture->hash,
                                              .frame = picture->frame->frame,
                                              .thread_count = worker->options->encode_threads,
                                              .accepts_missed = true},
                        result, error);
        if (!ok) error_prefix(error, "the file written does not verify");
    }
    close(fd);
    if (!ok) part_file_remove(picture->frame, picture->folder_fd);
    return ok;
}

// Refuses pictures with too large a share of cut light before they are encoded. The share of a picture that is not
// finite means nothing.
static bool check_rays(const struct picture *picture, enum report_fault *fault, struct error *error)
{
    *fault = REPORT_FAULT_CUT;
    if (ray_counts_check(&picture->ray_counts, &picture->frame->job->job.quality, error)) return true;
    if (!is_finite(picture, error)) *fault = REPORT_FAULT_FRAME;
    return false;
}

static struct frame_accuracy find_accuracy(const struct picture *picture)
{
    struct frame_accuracy accuracy = audit_result_accuracy(&picture->audit, job_method_name(picture->method));

    accuracy.plan = picture->plan_number;
    accuracy.has_cut_share = picture->ray_counts.is_known;
    accuracy.cut_share = picture->ray_counts.cut_share;
    accuracy.traced = picture->traced;
    return accuracy;
}

static void encode(struct worker *worker, struct picture *picture)
{
    struct assignment_frame *frame = picture->frame;
    enum report_fault fault;
    struct gate_result result;
    struct frame_accuracy accuracy = find_accuracy(picture);
    struct error error = {0};
    double start_s = clock_now_s(), encode_s;

    if (worker_is_unwanted(worker, frame)) {
        worker_drop_frame(worker, frame);
        return;
    }
    if (!check_rays(picture, &fault, &error) || !write_part(worker, picture, &result, &fault, &error)) {
        report_frame_failed(&worker->connection, frame, fault, error.message);
        worker_end_frame(worker, frame);
        return;
    }
    if (worker_is_unwanted(worker, frame)) {
        part_file_remove(frame, picture->folder_fd);
        worker_drop_frame(worker, frame);
        return;
    }
    encode_s = clock_now_s() - start_s;
    live_preview_show_final(&worker->preview, frame->job->preview, &picture->image);
    report_finished(&worker->connection, frame,
                    &(struct report_result){.file = &result.file,
                                            .accuracy = &accuracy,
                                            .render_s = picture->render_s,
                                            .encode_s = encode_s,
                                            .audit_s = picture->audit.seconds,
                                            .weight = picture->weight});
    worker_end_frame(worker, frame);
}

// Waits for the next picture. NULL when the renderer has ended.
static struct picture *take_picture(struct worker *worker)
{
    struct picture *picture;

    pthread_mutex_lock(&worker->lock);
    while (!worker->rendered && !worker->has_renderer_ended)
        pthread_cond_wait(&worker->changed, &worker->lock);
    picture = worker->rendered;
    worker->rendered = NULL;
    pthread_cond_broadcast(&worker->changed);
    pthread_mutex_unlock(&worker->lock);
    return picture;
}

void *encoder_run(void *user)
{
    struct worker *worker = user;
    struct picture *picture;

    while ((picture = take_picture(worker))) {
        encode(worker, picture);
        live_preview_end_final(&worker->preview);
        worker_return_picture(worker, picture);
    }
    worker_end_thread(worker);
    return NULL;
}
