// SPDX-License-Identifier: Apache-2.0
#include "worker/process/render_loop.h"

#include "core/base/error.h"
#include "core/job/output_root.h"
#include "core/job/quality_json.h"
#include "core/json/json_write.h"
#include "worker/answer/request.h"
#include "worker/answer/requests.h"
#include "worker/audit/gate.h"
#include "worker/gl/gl_context.h"
#include "worker/picture/image_exr.h"
#include "worker/plan/plan_segment.h"
#include "worker/plan/tolerance.h"
#include "worker/process/options.h"
#include "worker/process/part_file.h"
#include "worker/process/plan_post.h"
#include "worker/process/report.h"
#include "worker/process/worker.h"
#include "worker/render/renderer.h"
#include "worker/sandbox/sandbox.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct render_loop {
    struct worker *worker;
    struct gl_context *context;     // NULL with --backend none
    struct renderer *renderer;      // likewise
    struct tolerance *tolerance;    // likewise
    struct assignment_frame *frame; // being rendered
    enum frame_phase phase;         // of that frame, never FRAME_PHASE_LINK
    double phase_progress;          // share of it that is done; it only grows
    double foretold_s;              // of a frame's rendering, by the plan that was made last; 0: not known
    // The frame whose files are being read ahead; its job -1: none.
    int64_t expected_job;
    int32_t expected_frame;
};

// Has the next frame's files read while this one is rendered. The next frame may be dropped at any time: it is used
// only under the lock.
static void expect_next(struct render_loop *loop)
{
    struct worker *worker = loop->worker;
    const struct assignment_frame *next;

    pthread_mutex_lock(&worker->lock);
    next = assignment_find_waiting(&worker->assignment);
    if (next && !next->job->fault && loop->renderer &&
        (next->job->id != loop->expected_job || next->frame != loop->expected_frame)) {
        loop->expected_job = next->job->id;
        loop->expected_frame = next->frame;
        renderer_expect(loop->renderer, &next->job->job, next->frame);
    }
    pthread_mutex_unlock(&worker->lock);
}

static void tell(const struct render_loop *loop, enum frame_phase phase, double progress)
{
    const struct assignment_frame *frame = loop->frame;

    worker_set_doing(loop->worker,
                     &(struct report_doing){frame->job->id, frame->frame, frame->attempt, phase, progress});
}

static void begin_phase(struct render_loop *loop, enum frame_phase phase)
{
    loop->phase = phase;
    loop->phase_progress = 0.0;
    tell(loop, phase, 0.0);
}

// How long GL links is unknown.
static void on_link(void *user, bool begins)
{
    struct render_loop *loop = user;

    if (!loop->frame) return;
    tell(loop, begins ? FRAME_PHASE_LINK : loop->phase, begins ? -1.0 : loop->phase_progress);
}

static bool on_progress(void *user, double done)
{
    struct render_loop *loop = user;

    worker_advance(loop->worker);
    loop->phase_progress = fmin(fmax(loop->phase_progress, done), 1.0);
    tell(loop, loop->phase, loop->phase_progress);
    expect_next(loop);
    return !worker_is_unwanted(loop->worker, loop->frame);
}

static void on_level(void *user, const struct picture_level *level)
{
    struct render_loop *loop = user;

    live_preview_show_level(&loop->worker->preview, loop->frame->job->preview, level);
}

static void on_phase(void *user, enum frame_phase phase)
{
    struct render_loop *loop = user;
    const struct assignment_frame *frame = loop->frame;

    if (phase == FRAME_PHASE_PLAN && loop->phase != FRAME_PHASE_PLAN) {
        loop->foretold_s = 0.0;
        report_planning(&loop->worker->connection, frame);
    }
    if (phase != FRAME_PHASE_PLAN && loop->phase == FRAME_PHASE_PLAN)
        report_planned(&loop->worker->connection, frame, plan_segment_of(&frame->job->job, frame->frame).count,
                       loop->foretold_s);
    begin_phase(loop, phase);
}

static void on_planned(void *user, double render_s)
{
    struct render_loop *loop = user;

    loop->foretold_s = render_s;
}

// The plan is made by another worker: how far it is is unknown here.
static void on_wait(void *user)
{
    on_phase(user, FRAME_PHASE_PLAN);
    tell(user, FRAME_PHASE_PLAN, -1.0);
}

// Enters the sandbox, unless the worker is fenced: a fence was entered before threads started.
static bool close_sandbox(struct worker *worker)
{
    struct error error = {0};

    if (!worker->options->has_sandbox || worker->options->is_fenced || sandbox_enter(worker->sandbox, &error))
        return true;
    report_unable(&worker->connection, "worker", error.message);
    return false;
}

static bool make_renderer(struct render_loop *loop)
{
    struct worker *worker = loop->worker;
    const struct options *options = worker->options;
    const struct gl_context_facts *facts;
    struct error error = {0};

    if (!options->has_context) {
        if (!close_sandbox(worker)) return false;
        report_ready(&worker->connection, NULL, worker->sandbox);
        worker_set_ready(worker);
        return true;
    }
    loop->context = gl_context_create(options->backend, options->device, &error);
    if (!loop->context) {
        error_prefix(&error, "no GL context");
        report_unable(&worker->connection, "worker", error.message);
        return false;
    }
    if (!close_sandbox(worker)) return false;
    loop->renderer = renderer_create(loop->context, options->shader_dir);
    loop->tolerance = tolerance_create(loop->renderer);
    renderer_watch_links(loop->renderer, on_link, loop);
    facts = gl_context_facts(loop->context);
    snprintf(worker->backend, sizeof worker->backend, "%s", facts->backend);
    snprintf(worker->renderer, sizeof worker->renderer, "%s", facts->renderer);
    report_ready(&worker->connection, facts, worker->sandbox);
    worker_set_ready(worker);
    return true;
}

static enum report_fault fault_of(enum renderer_fault fault)
{
    switch (fault) {
    case RENDERER_FAULT_JOB:
        return REPORT_FAULT_JOB;
    case RENDERER_FAULT_ENDLESS:
    case RENDERER_FAULT_MAJORANT:
        return REPORT_FAULT_ENDLESS;
    case RENDERER_FAULT_CONTEXT:
        return REPORT_FAULT_WORKER;
    case RENDERER_FAULT_MISSED:
        return REPORT_FAULT_MISSED;
    default:
        return REPORT_FAULT_FRAME;
    }
}

static void fail_frame(struct render_loop *loop, enum report_fault fault, const char *reason)
{
    report_frame_failed(&loop->worker->connection, loop->frame, fault, reason);
    worker_end_frame(loop->worker, loop->frame);
}

// Gives the picture to the encoder, which has taken the one before: no frame is started while a picture waits.
static void hand_over(struct render_loop *loop, struct picture *picture)
{
    struct worker *worker = loop->worker;

    report_rendered(&worker->connection, loop->frame);
    live_preview_expect_final(&worker->preview, loop->frame->job->preview);
    pthread_mutex_lock(&worker->lock);
    worker->rendered = picture;
    pthread_cond_broadcast(&worker->changed);
    pthread_mutex_unlock(&worker->lock);
}

// The settings of a planned frame, as a job would state them.
static void format_quality(struct picture *picture, const struct job *job, const struct tolerance_result *result)
{
    struct json_writer writer = {0};

    picture->quality[0] = 0;
    picture->plan_number = result->plan_number;
    picture->weight = result->weight;
    if (result->plan_number == 0) return;
    quality_to_json(&writer, job, &result->quality);
    if (writer.length < sizeof picture->quality) memcpy(picture->quality, writer.text, writer.length + 1);
    json_writer_finish(&writer);
}

static void fill_picture(struct picture *picture, const struct held_job *job, const struct tolerance_result *result)
{
    const struct renderer_result *render = &result->render;

    format_quality(picture, &job->job, result);
    picture->render_s = render->seconds;
    memcpy(picture->world_to_camera, render->world_to_camera, sizeof picture->world_to_camera);
    memcpy(picture->world_to_ndc, render->world_to_ndc, sizeof picture->world_to_ndc);
    snprintf(picture->shader_hash, sizeof picture->shader_hash, "%s", render->shader_hash ? render->shader_hash : "");
    memcpy(picture->hash, render->picture_hash, sizeof picture->hash);
    picture->method = result->quality.method;
    picture->paths = result->quality.method == JOB_METHOD_PATHS
                         ? (double)result->quality.paths * (result->quality.samples > 1 ? result->quality.samples : 1)
                         : 0.0;
    picture->step = render->step;
    picture->ray_counts = render->ray_counts;
    picture->traced = result->quality.pixels.stride > 0 ? render->traced : 0.0;
    picture->audit = result->audit;
    picture->sampling_error = result->audit.sampling_error;
    picture->beyond = result->beyond;
    snprintf(picture->plan, sizeof picture->plan, "%s", job->draft ? job->draft : result->reason);
}

// Takes over `folder_fd`.
static void render_picture(struct render_loop *loop, int folder_fd, struct picture *picture)
{
    const struct held_job *job = loop->frame->job;
    struct plan_post post = {.worker = loop->worker, .frame = loop->frame, .on_wait = on_wait, .user = loop};
    const struct plan_source source = plan_post_open(&post);
    const struct tolerance_params params = {.job = &job->job,
                                            .serial = job->serial,
                                            .source = job->asks_plans ? &source : NULL,
                                            .repeated = job->plan_of ? &job->stated : NULL,
                                            .repeated_number = job->stated_number,
                                            .repeated_beyond = job->stated_beyond,
                                            .frame = loop->frame->frame,
                                            .image = &picture->image,
                                            .on_progress = on_progress,
                                            .on_level = on_level,
                                            .on_phase = on_phase,
                                            .on_planned = on_planned,
                                            .user = loop};
    struct tolerance_result result;
    struct error error = {0};
    enum renderer_fault fault;

    picture->folder_fd = folder_fd;
    if (tolerance_render(loop->tolerance, &params, &result, &error)) {
        fill_picture(picture, job, &result);
        hand_over(loop, picture);
        return;
    }
    fault = result.render.fault;
    picture_destroy(picture);
    if (fault == RENDERER_FAULT_STOPPED) {
        worker_drop_frame(loop->worker, loop->frame);
        return;
    }
    fail_frame(loop, fault_of(fault), error.message);
    if (fault == RENDERER_FAULT_CONTEXT) worker_exit(loop->worker, 1);
}

// Reports an existing file, with the accuracy that its header states.
static void tell_skipped(struct render_loop *loop, const struct gate_result *found)
{
    struct frame_accuracy accuracy = image_exr_accuracy(&found->facts);

    report_skipped(&loop->worker->connection, loop->frame,
                   &(struct report_result){.file = &found->file, .accuracy = &accuracy});
}

// Reports a part file that an earlier daemon's worker left.
static void tell_found(struct render_loop *loop, const struct gate_result *found)
{
    struct frame_accuracy accuracy = image_exr_accuracy(&found->facts);

    report_finished(
        &loop->worker->connection, loop->frame,
        &(struct report_result){
            .file = &found->file, .accuracy = &accuracy, .render_s = found->facts.render_seconds, .is_found = true});
}

static void render_frame(struct render_loop *loop)
{
    struct connection *connection = &loop->worker->connection;
    const struct held_job *job = loop->frame->job;
    char picture_hash[HASH_TEXT_SIZE];
    enum renderer_fault fault;
    struct gate_result found;
    struct error error = {0};
    struct picture *picture;
    int folder_fd;

    report_started(connection, loop->frame);
    begin_phase(loop, FRAME_PHASE_RENDER);
    if (job->fault) {
        fail_frame(loop, REPORT_FAULT_JOB, job->fault);
        return;
    }
    if (!loop->renderer) {
        fail_frame(loop, REPORT_FAULT_WORKER, "the worker has no GL context: it was started with --backend none");
        return;
    }
    if (!renderer_hash_picture(loop->renderer, &job->job, loop->frame->frame, picture_hash, &fault, &error)) {
        fail_frame(loop, fault_of(fault), error.message);
        return;
    }
    folder_fd = part_file_open_folder(loop->frame, &error);
    if (folder_fd < 0) {
        fail_frame(loop, folder_fd == OUTPUT_ROOT_AWAY ? REPORT_FAULT_ROOT : REPORT_FAULT_OUTPUT, error.message);
        return;
    }
    switch (part_file_find_existing(loop->frame, picture_hash, folder_fd, &found, &error)) {
    case PART_FILE_SKIP:
        tell_skipped(loop, &found);
        worker_end_frame(loop->worker, loop->frame);
        break;
    case PART_FILE_REFUSE:
        fail_frame(loop, REPORT_FAULT_FRAME, error.message);
        break;
    case PART_FILE_RENDER:
        if (part_file_take_old(loop->frame, picture_hash, folder_fd, &found)) {
            tell_found(loop, &found);
            worker_end_frame(loop->worker, loop->frame);
            break;
        }
        picture = worker_make_picture(loop->worker, loop->frame, &error);
        if (picture) {
            render_picture(loop, folder_fd, picture);
            return;
        }
        fail_frame(loop, REPORT_FAULT_FRAME, error.message);
    }
    close(folder_fd);
}

// Waits for a request or a frame. False when the worker ends.
static bool wait_for_work(struct render_loop *loop, struct request **request)
{
    struct worker *worker = loop->worker;

    *request = NULL;
    loop->frame = NULL;
    pthread_mutex_lock(&worker->lock);
    worker->doing = (struct report_doing){0};
    while (!worker->is_abandoned) {
        if (worker->requests) {
            *request = worker->requests;
            worker->requests = (*request)->next;
            break;
        }
        if (worker->is_exiting) break;
        if (!worker->rendered) loop->frame = assignment_start_frame(&worker->assignment);
        if (loop->frame) break;
        pthread_cond_wait(&worker->changed, &worker->lock);
    }
    pthread_mutex_unlock(&worker->lock);
    return *request || loop->frame;
}

static bool is_answer_wanted(void *user)
{
    struct worker *worker = user;
    bool is_wanted;

    worker_advance(worker);
    pthread_mutex_lock(&worker->lock);
    is_wanted = !worker->is_abandoned;
    pthread_mutex_unlock(&worker->lock);
    return is_wanted;
}

static void on_part(void *user, int64_t done, int64_t count, double share)
{
    struct worker *worker = user;

    report_part(&worker->connection, done, count, share);
}

static void work(struct render_loop *loop)
{
    struct worker *worker = loop->worker;
    const struct request_tools tools = {.shader_dir = worker->options->shader_dir,
                                        .context = loop->context,
                                        .renderer = loop->renderer,
                                        .is_wanted = is_answer_wanted,
                                        .on_part = on_part,
                                        .user = worker};
    struct json_writer reply = {0};
    struct request *request;

    while (wait_for_work(loop, &request)) {
        if (!request) {
            render_frame(loop);
            continue;
        }
        requests_answer(request, &tools, &reply);
        connection_send(&worker->connection, &reply);
        request_destroy(request);
        worker_advance(worker);
    }
    json_writer_finish(&reply);
}

void *render_loop_run(void *user)
{
    struct render_loop loop = {.worker = user, .expected_job = -1};
    struct worker *worker = user;

    if (make_renderer(&loop))
        work(&loop);
    else
        worker_exit(worker, 1);
    tolerance_destroy(loop.tolerance);
    if (loop.renderer) renderer_destroy(loop.renderer);
    if (loop.context) gl_context_destroy(loop.context);
    pthread_mutex_lock(&worker->lock);
    worker->has_renderer_ended = true;
    pthread_cond_broadcast(&worker->changed);
    pthread_mutex_unlock(&worker->lock);
    worker_end_thread(worker);
    return NULL;
}
