// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/measure_requests.h"

#include "core/base/error.h"
#include "core/job/frame_range.h"
#include "core/job/job_hash.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "worker/answer/chart_truth.h"
#include "worker/answer/measure.h"
#include "worker/audit/truth.h"
#include "worker/gl/gl_context.h"
#include "worker/gl/gl_timer.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"
#include "worker/scene/scene_extent.h"
#include "worker/scene/scene_inputs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double SECONDS_MAX = 86400;
static const double HALVING_COST = 4; // of a march in half the steps, along camera and shadow rays
static const double NO_CHANGE = 1e-5; // a smaller change ends the halving

static bool read_frame(const struct json_node *params, int32_t *frame, struct error *error)
{
    struct json_node node = json_node_child(params, "frame");
    int64_t integer;

    if (!json_read_integer(&node, 0, FRAME_NUMBER_LIMIT - 1, &integer, error)) return false;
    *frame = (int32_t)integer;
    return true;
}

static bool read_seconds(const struct json_node *params, const char *key, double *seconds, struct error *error)
{
    struct json_node node = json_node_child(params, key);

    return json_read_number(&node, 0, SECONDS_MAX, seconds, error);
}

static bool read_text(const struct json_node *params, const char *key, const char **text, struct error *error)
{
    struct json_node node = json_node_child(params, key);

    return json_read_string(&node, text, error);
}

bool measure_answer_reach(const struct json_node *params, const struct request_tools *tools, struct json_writer *writer,
                          enum message_code *code, struct error *error)
{
    struct job job = {0};
    struct scene_inputs inputs = {0};
    struct scene_extent reach;
    int32_t frame;
    bool ok = false;

    *code = MESSAGE_CODE_PARAMS;
    if (!read_frame(params, &frame, error) || !request_read_job(params, &job, error)) return false;
    *code = MESSAGE_CODE_INTERNAL;
    if (!scene_inputs_open(&inputs, &job, frame, NULL, NULL, error)) goto out;
    reach = scene_extent_find(&job, &inputs, frame);
    json_write_begin_object(writer);
    json_write_number_member(writer, "near", reach.near);
    json_write_number_member(writer, "far", reach.far);
    json_write_number_member(writer, "length", reach.length);
    json_write_number_member(writer, "voxel", reach.voxel);
    json_write_end_object(writer);
    ok = true;
out:
    scene_inputs_finish(&inputs);
    job_finish(&job);
    return ok;
}

// A hash of everything that the truth depends on: neither the method nor the limits of paths.
static bool hash_scene(const struct request_tools *tools, const struct job *job, int32_t frame,
                       char scene[static HASH_TEXT_SIZE], struct error *error)
{
    struct job plain = *job; // never finished
    char text[HASH_TEXT_SIZE + 16];
    enum renderer_fault fault;

    plain.quality = (struct job_quality){.samples = job->quality.samples};
    job_hash_picture(&plain, plain.hash);
    if (!renderer_hash_picture(tools->renderer, &plain, frame, scene, &fault, error)) return false;
    hash_bytes(text, (size_t)snprintf(text, sizeof text, "%s %d", scene, (int)frame), scene);
    return true;
}

// RMS of the difference, relative to `to`; INFINITY without a picture to compare.
static double find_change(const struct image *from, const struct image *to)
{
    size_t count = 4 * (size_t)to->width_px * (size_t)to->height_px;
    double squares = 0, light = 0;

    if (!from->rgba) return INFINITY;
    for (size_t i = 0; i < count; i++) {
        squares += pow((double)to->rgba[i] - from->rgba[i], 2);
        light += pow(to->rgba[i], 2);
    }
    return light > 0 ? sqrt(squares / light) : 0;
}

// Renders marches, each in half the steps of the one before, until the time is over or nothing changes, and keeps the
// last.
static bool render_finest(const struct request_tools *tools, const struct job *job, int32_t frame, double seconds,
                          struct image *finest, struct error *error)
{
    struct job halved = *job; // never finished
    struct measure_params params = {.renderer = tools->renderer,
                                    .job = &halved,
                                    .frame = frame,
                                    .is_wanted = tools->is_wanted,
                                    .user = tools->user};
    struct image image = {0};
    double left_s = seconds, took_s, change = INFINITY;
    bool has_finest = false;

    do {
        params.limit_s = has_finest ? left_s : SECONDS_MAX;
        if (!image_init_for_job(&image, job, error)) break;
        if (measure_render(&params, &image, &took_s, error) != MEASURE_DONE) break;
        change = find_change(finest, &image);
        image_finish(finest);
        *finest = image;
        image = (struct image){0};
        has_finest = true;
        left_s -= took_s;
        halved.quality.step *= 0.5;
        halved.quality.light_step *= 0.5;
        halved.quality.min_transmittance = 0;
    } while (left_s > HALVING_COST * took_s && change > NO_CHANGE);
    image_finish(&image);
    return has_finest;
}

struct truth_request {
    struct job job, coarser_job;
    int32_t frame;
    double seconds;
    const char *file;
};

static bool read_truth_request(const struct json_node *params, struct truth_request *request, struct error *error)
{
    struct json_node coarser = json_node_child(params, "coarser");

    return read_frame(params, &request->frame, error) && read_seconds(params, "seconds", &request->seconds, error) &&
           read_text(params, "file", &request->file, error) && request_read_job(params, &request->job, error) &&
           request_read_job(&coarser, &request->coarser_job, error);
}

static bool find_truth(const struct truth_request *request, const struct request_tools *tools, const char *scene,
                       struct chart_truth *truth, struct error *error)
{
    struct measure_params params = {.renderer = tools->renderer,
                                    .job = &request->job,
                                    .frame = request->frame,
                                    .limit_s = SECONDS_MAX,
                                    .is_wanted = tools->is_wanted,
                                    .user = tools->user};
    struct image finer = {0}, coarser = {0}, finest = {0};
    double finer_s, coarser_s;
    bool ok = false;

    if (!truth_has_twin(&request->job) && truth_is_random(&request->job)) {
        error_set(error, "nothing knows the light of a density in GLSL above order 1");
        return false;
    }
    if (!image_init_for_job(&finer, &request->job, error) || !image_init_for_job(&coarser, &request->job, error))
        goto out;
    if (measure_render(&params, &finer, &finer_s, error) != MEASURE_DONE) goto out;
    params.job = &request->coarser_job;
    if (measure_render(&params, &coarser, &coarser_s, error) != MEASURE_DONE) goto out;
    if (!truth_has_twin(&request->job) &&
        !render_finest(tools, &request->job, request->frame, request->seconds, &finest, error))
        goto out;
    ok = chart_truth_find(truth,
                          &(struct chart_truth_params){.job = &request->job,
                                                       .frame = request->frame,
                                                       .finer = &finer,
                                                       .coarser = &coarser,
                                                       .seconds = request->seconds,
                                                       .finest = finest.rgba ? &finest : NULL,
                                                       .is_wanted = tools->is_wanted,
                                                       .user = tools->user},
                          error);
    if (ok) snprintf(truth->scene, sizeof truth->scene, "%s", scene);
    ok = ok && chart_truth_save(truth, request->file, error);
out:
    image_finish(&finest);
    image_finish(&coarser);
    image_finish(&finer);
    return ok;
}

static void write_truth(struct json_writer *writer, const struct chart_truth *truth,
                        const struct gl_context_facts *facts)
{
    json_write_begin_object(writer);
    json_write_string_member(writer, "scene", truth->scene);
    json_write_string_member(writer, "truth", truth->kind);
    json_write_integer_member(writer, "pixels", (int64_t)truth->count);
    json_write_string_member(writer, "backend", facts->backend);
    json_write_string_member(writer, "renderer", facts->renderer);
    json_write_end_object(writer);
}

bool measure_answer_truth(const struct json_node *params, const struct request_tools *tools, struct json_writer *writer,
                          enum message_code *code, struct error *error)
{
    struct truth_request request = {0};
    char scene[HASH_TEXT_SIZE] = {0};
    struct chart_truth truth = {0};
    bool ok = false;

    *code = MESSAGE_CODE_PARAMS;
    if (!read_truth_request(params, &request, error)) goto out;
    *code = MESSAGE_CODE_INTERNAL;
    if (!request_check_renderer(tools, error) || !hash_scene(tools, &request.job, request.frame, scene, error))
        goto out;
    ok = chart_truth_load(&truth, request.file, scene, NULL) || find_truth(&request, tools, scene, &truth, error);
    if (ok) write_truth(writer, &truth, gl_context_facts(tools->context));
out:
    chart_truth_finish(&truth);
    job_finish(&request.coarser_job);
    job_finish(&request.job);
    return ok;
}

struct setting {
    struct job job;
    int32_t frame;
    double limit_s;
    const char *file;
};

static void write_outcome(struct json_writer *writer, enum measure_outcome outcome, const struct error *reason)
{
    json_write_string_member(writer, "outcome",
                             outcome == MEASURE_DONE       ? "measured"
                             : outcome == MEASURE_TOO_SLOW ? "too slow"
                                                           : "refused");
    if (outcome == MEASURE_REFUSED) json_write_string_member(writer, "reason", reason->message);
}

static bool measure_setting(const struct setting *setting, const struct request_tools *tools,
                            const struct chart_truth *truth, struct json_writer *writer, struct error *error)
{
    struct measure_params params = {.renderer = tools->renderer,
                                    .timer = gl_timer_create(tools->context),
                                    .job = &setting->job,
                                    .frame = setting->frame,
                                    .limit_s = setting->limit_s,
                                    .is_wanted = tools->is_wanted,
                                    .user = tools->user};
    struct chart_error difference = {0};
    enum measure_outcome outcome;
    struct error reason = {{0}};
    struct image image = {0};
    double seconds = setting->limit_s;
    int repeats = 0;

    if (!image_init_for_job(&image, &setting->job, error)) {
        gl_timer_destroy(params.timer);
        return false;
    }
    outcome = measure_time(&params, &image, &seconds, &repeats, &reason);
    if (outcome == MEASURE_DONE) difference = chart_truth_compare(truth, &image, setting->job.output.pixel);
    json_write_begin_object(writer);
    write_outcome(writer, outcome, &reason);
    json_write_number_member(writer, "seconds", seconds);
    json_write_integer_member(writer, "repeats", repeats);
    json_write_string_member(writer, "timer", params.timer ? "gpu" : "wall");
    json_write_number_member(writer, "error", difference.relative_rmse); // null where it is infinite
    json_write_number_member(writer, "largest_error", difference.largest);
    json_write_string_member(writer, "truth", truth->kind);
    json_write_integer_member(writer, "pixels", (int64_t)truth->count);
    json_write_end_object(writer);
    image_finish(&image);
    gl_timer_destroy(params.timer);
    return true;
}

bool measure_answer_setting(const struct json_node *params, const struct request_tools *tools,
                            struct json_writer *writer, enum message_code *code, struct error *error)
{
    struct setting setting = {0};
    struct chart_truth truth = {0};
    const char *scene;
    bool ok = false;

    *code = MESSAGE_CODE_PARAMS;
    if (!read_frame(params, &setting.frame, error) || !read_seconds(params, "limit_s", &setting.limit_s, error) ||
        !read_text(params, "file", &setting.file, error) || !read_text(params, "scene", &scene, error) ||
        !request_read_job(params, &setting.job, error))
        goto out;
    *code = MESSAGE_CODE_INTERNAL;
    ok = request_check_renderer(tools, error) && chart_truth_load(&truth, setting.file, scene, error) &&
         measure_setting(&setting, tools, &truth, writer, error);
out:
    chart_truth_finish(&truth);
    job_finish(&setting.job);
    return ok;
}
