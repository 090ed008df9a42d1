// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/requests.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/json/json_write.h"
#include "worker/answer/beyond_answer.h"
#include "worker/answer/explain.h"
#include "worker/answer/measure_requests.h"
#include "worker/answer/plan_answer.h"
#include "worker/answer/request.h"
#include "worker/answer/request_picture.h"
#include "worker/answer/request_verify.h"
#include "worker/answer/unseen.h"
#include "worker/plan/draft.h"
#include "worker/plan/plan.h"
#include "worker/sheet/preview.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_LIMIT = 100 * 1000, TILE_WIDTH_LIMIT = 4096, COLUMN_LIMIT = 1000, EXPOSURE_LIMIT_STOPS = 60 };

// A job with a tolerance is explained as planned, or as its draft, which takes no time.
static bool write_explanation(const struct job *job, bool is_planned, const struct request_tools *tools,
                              struct json_writer *writer, struct error *error)
{
    struct json_writer predicted = {0};
    struct job_beyond beyond = {0};
    struct draft draft;
    struct plan plan;
    struct job explained = *job;
    bool is_auto = job->quality.method == JOB_METHOD_AUTO, ok = true;

    if (is_auto && is_planned) {
        ok = plan_answer_write(job, tools, &predicted, &plan, error);
        if (ok) explained = plan_apply(&plan, job);
        if (ok) beyond = plan.beyond;
    } else if (is_auto) {
        ok = draft_choose(&draft, job, error);
        if (ok) explained.quality = draft.quality;
    }
    if (!predicted.text) ok = ok && beyond_answer_find(&explained, tools, &beyond, error);
    ok = ok && explain_write(&(struct explain_params){.job = &explained,
                                                      .shader_dir = tools->shader_dir,
                                                      .plan = predicted.text ? &predicted : NULL,
                                                      .beyond = &beyond},
                             writer, error);
    json_writer_finish(&predicted);
    return ok;
}

static bool answer_explain(const struct json_node *params, const struct request_tools *tools,
                           struct json_writer *writer, enum message_code *code, struct error *error)
{
    struct json_node plan = json_node_child(params, "plan");
    struct job job = {0};
    bool is_planned = false, ok;

    *code = MESSAGE_CODE_PARAMS;
    if (!json_node_is_absent(&plan) && !json_read_bool(&plan, &is_planned, error)) return false;
    if (!request_read_job(params, &job, error)) return false;
    *code = MESSAGE_CODE_INTERNAL;
    ok = write_explanation(&job, is_planned, tools, writer, error);
    job_finish(&job);
    return ok;
}

static bool answer_plan(const struct json_node *params, const struct request_tools *tools, struct json_writer *writer,
                        enum message_code *code, struct error *error)
{
    struct job job = {0};
    bool ok;

    *code = MESSAGE_CODE_PARAMS;
    if (!request_read_job(params, &job, error)) return false;
    ok = job.quality.method == JOB_METHOD_AUTO;
    if (!ok) {
        error_set(error, "quality: expected a tolerance, as other jobs say themselves how they are rendered");
    } else {
        *code = MESSAGE_CODE_INTERNAL;
        ok = plan_answer_write(&job, tools, writer, NULL, error);
    }
    job_finish(&job);
    return ok;
}

// The strings of an array, borrowed from the document; the array itself is owned by the caller.
static bool read_strings(const struct json_node *node, const char ***strings, size_t *count, struct error *error)
{
    struct json_node element = {0};

    if (!json_check_array(node, 1, FILE_LIMIT, error)) return false;
    *count = json_node_count(node);
    *strings = xcalloc(*count, sizeof **strings);
    for (size_t i = 0; json_node_next(node, &element); i++)
        if (!json_read_string(&element, &(*strings)[i], error)) return false;
    return true;
}

static bool read_optional_integer(const struct json_node *params, const char *key, int max, int *number,
                                  struct error *error)
{
    struct json_node node = json_node_child(params, key);
    int64_t integer;

    if (json_node_is_absent(&node)) return true;
    if (!json_read_integer(&node, 0, max, &integer, error)) return false;
    *number = (int)integer;
    return true;
}

static bool read_exposure(const struct json_node *params, struct preview_params *preview, struct error *error)
{
    struct json_node node = json_node_child(params, "exposure");

    preview->has_exposure = !json_node_is_absent(&node) && json_node_type(&node) != JSON_NULL;
    return !preview->has_exposure ||
           json_read_number(&node, -EXPOSURE_LIMIT_STOPS, EXPOSURE_LIMIT_STOPS, &preview->exposure, error);
}

static bool read_labels(const struct json_node *params, struct preview_params *preview, const char ***labels,
                        struct error *error)
{
    struct json_node node = json_node_child(params, "labels");
    size_t count;

    if (json_node_is_absent(&node) || json_node_type(&node) == JSON_NULL) return true;
    if (!read_strings(&node, labels, &count, error)) return false;
    if (count != preview->file_count) return json_fail(&node, error, "expected as many labels as files");
    preview->labels = *labels;
    return true;
}

static bool answer_preview(const struct json_node *params, const struct request_tools *tools,
                           struct json_writer *writer, enum message_code *code, struct error *error)
{
    struct json_node files = json_node_child(params, "files"), out = json_node_child(params, "out");
    const char **names = NULL, **labels = NULL;
    struct preview_params preview = {0};
    struct preview_result result;
    bool ok;

    *code = MESSAGE_CODE_PARAMS;
    ok = read_strings(&files, &names, &preview.file_count, error) && read_labels(params, &preview, &labels, error) &&
         read_optional_integer(params, "columns", COLUMN_LIMIT, &preview.columns, error) &&
         read_optional_integer(params, "tile_width_px", TILE_WIDTH_LIMIT, &preview.tile_width_px, error) &&
         read_exposure(params, &preview, error) && json_read_string(&out, &preview.out, error);
    preview.files = names;
    if (ok) {
        *code = MESSAGE_CODE_INTERNAL;
        ok = preview_write_sheet(&preview, &result, error);
    }
    if (ok) {
        json_write_begin_object(writer);
        json_write_number_member(writer, "exposure", result.exposure);
        json_write_integer_member(writer, "width_px", result.width_px);
        json_write_integer_member(writer, "height_px", result.height_px);
        json_write_end_object(writer);
    }
    free(names);
    free(labels);
    return ok;
}

static void write_fps(const struct preview_result *result, struct json_writer *writer)
{
    if (result->fps_numerator == 0) return;
    json_write_key(writer, "fps");
    json_write_begin_array(writer);
    json_write_integer(writer, result->fps_numerator);
    json_write_integer(writer, result->fps_denominator);
    json_write_end_array(writer);
}

static bool answer_frames_png(const struct json_node *params, const struct request_tools *tools,
                              struct json_writer *writer, enum message_code *code, struct error *error)
{
    struct json_node files = json_node_child(params, "files"), folder = json_node_child(params, "folder");
    const char **names = NULL;
    struct preview_params preview = {0};
    struct preview_result result;
    bool ok;

    *code = MESSAGE_CODE_PARAMS;
    ok = read_strings(&files, &names, &preview.file_count, error) && read_exposure(params, &preview, error) &&
         json_read_string(&folder, &preview.out, error);
    preview.files = names;
    if (ok) {
        *code = MESSAGE_CODE_INTERNAL;
        ok = preview_write_frames(&preview, &result, error);
    }
    if (ok) {
        json_write_begin_object(writer);
        json_write_key(writer, "files");
        json_write_begin_array(writer);
        for (size_t i = 0; i < preview.file_count; i++) {
            char name[PREVIEW_NAME_SIZE];

            preview_format_name(i, name);
            json_write_string(writer, name);
        }
        json_write_end_array(writer);
        json_write_number_member(writer, "exposure", result.exposure);
        write_fps(&result, writer);
        json_write_end_object(writer);
    }
    free(names);
    return ok;
}

static const struct {
    const char *method;
    request_function *answer;
} answers[] = {
    {"worker.explain", answer_explain},
    {"worker.preview", answer_preview},
    {"worker.frames_png", answer_frames_png},
    {"worker.picture", request_answer_picture},
    {"worker.header", request_answer_header},
    {"worker.reach", measure_answer_reach},
    {"worker.truth", measure_answer_truth},
    {"worker.measure", measure_answer_setting},
    {"worker.error_strip", measure_answer_strip},
    {"worker.verify", request_answer_verify},
    {"worker.plan", answer_plan},
    {"worker.unseen", unseen_answer},
    {"worker.beyond", beyond_answer},
};

static request_function *find_answer(const char *method)
{
    for (size_t i = 0; i < sizeof answers / sizeof answers[0]; i++)
        if (!strcmp(method, answers[i].method)) return answers[i].answer;
    return NULL;
}

bool requests_is_known(const char *method)
{
    return find_answer(method) != NULL;
}

void requests_answer(const struct request *request, const struct request_tools *tools, struct json_writer *reply)
{
    const struct message *message = &request->message;
    struct json_writer result = {0};
    enum message_code code = MESSAGE_CODE_INTERNAL;
    struct error error = {0};

    if (find_answer(message->method)(&message->body, tools, &result, &code, &error)) {
        message_begin_result(reply, message->id);
        json_write_raw(reply, result.text, result.length);
        message_end(reply);
    } else {
        message_write_error(reply, message->id, code, error.message);
    }
    json_writer_finish(&result);
}
