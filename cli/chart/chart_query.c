// SPDX-License-Identifier: Apache-2.0
#include "cli/chart/chart_query.h"

#include "cli/chart/chart_ladder.h"
#include "cli/job/job_document.h"
#include "cli/job/json_set.h"
#include "cli/peer/connection.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum exit_status chart_query_start(struct chart_query *query, struct error *error)
{
    return worker_child_start(&query->child, query->options, query->interrupt, error) ? EXIT_STATUS_DONE
                                                                                      : EXIT_STATUS_FAILED;
}

void chart_query_stop(struct chart_query *query, bool at_once)
{
    worker_child_stop(&query->child, at_once);
}

enum exit_status chart_query_restart(struct chart_query *query, struct error *error)
{
    chart_query_stop(query, true);
    return chart_query_start(query, error);
}

static char *set_value(char *document, const char *key, const char *value, struct error *error)
{
    char *assignment = xasprintf("%s=%s", key, value), *edited = json_set(document, assignment, error);

    free(assignment);
    free(document);
    return edited;
}

// Unbounded media have no far end.
static char *set_clip(char *document, const struct chart_scale *scale, struct error *error)
{
    char *clip, *edited;

    if (!isfinite(scale->far)) return document;
    clip = xasprintf("[%.9g,%.9g]", scale->near, scale->far);
    edited = set_value(document, "camera.clip", clip, error);
    free(clip);
    return edited;
}

static bool has_clip(const char *document)
{
    struct job job = {0};
    bool is_job = job_parse(&job, document, strlen(document), "/", NULL);
    bool has = is_job && isfinite(job.scene.camera.clip_far);

    job_finish(&job);
    return has;
}

char *chart_query_document(const char *document, const char *quality, const struct chart_scale *clip,
                           struct error *error)
{
    char *edited = xstrdup(document);
    struct job job = {0};

    if (clip && !has_clip(document)) edited = set_clip(edited, clip, error);
    if (edited) edited = set_value(edited, "quality", quality, error);
    if (edited && !job_parse(&job, edited, strlen(edited), "/", error)) {
        free(edited);
        edited = NULL;
    }
    job_finish(&job);
    return edited;
}

char *chart_query_with_samples(const char *quality, int samples)
{
    char *assignment = xasprintf("samples=%d", samples), *edited = json_set(quality, assignment, NULL);

    free(assignment);
    return edited ? edited : xstrdup(quality);
}

void chart_query_set_name(const struct json_node *job, struct chart_facts *facts)
{
    struct json_node node = json_node_child(job, "name");
    const char *name;

    if (!json_read_string(&node, &name, NULL)) name = "job";
    snprintf(facts->name, sizeof facts->name, "%s", name);
}

bool chart_query_is_there(const char *path)
{
    return access(path, F_OK) == 0;
}

// Reaps a worker that ended. Heartbeats that arrived meanwhile are dropped.
static enum exit_status ask(struct chart_query *query, const char *method, const struct json_writer *params,
                            struct message *reply, struct error *error)
{
    enum exit_status status = worker_child_call(&query->child, method, params->text, reply, error);
    struct message unasked;

    while (status == EXIT_STATUS_DONE &&
           connection_next(query->child.connection, 0, &unasked, NULL) == CONNECTION_MESSAGE)
        message_finish(&unasked);
    return status == EXIT_STATUS_FAILED && query->child.pid <= 0 ? EXIT_STATUS_NO_DAEMON : status;
}

static void begin(struct json_writer *params, const struct chart_query *query, const char *document)
{
    json_write_begin_object(params);
    json_write_string_member(params, "root", "/");
    json_write_integer_member(params, "frame", query->frame);
    if (!document) return;
    json_write_key(params, "document");
    json_write_raw(params, document, strlen(document));
}

static double number_of(const struct message *reply, const char *key, double otherwise)
{
    struct json_node node = json_node_child(&reply->body, key);
    double number;

    return json_read_number(&node, -HUGE_VAL, HUGE_VAL, &number, NULL) ? number : otherwise;
}

static void copy_text(const struct message *reply, const char *key, char *text, size_t size)
{
    struct json_node node = json_node_child(&reply->body, key);
    const char *value;

    snprintf(text, size, "%s", json_read_string(&node, &value, NULL) ? value : "");
}

// A request whose only parameter is the document.
static enum exit_status ask_of(struct chart_query *query, const char *method, const char *document,
                               struct message *reply, struct error *error)
{
    struct json_writer params = {0};
    enum exit_status status;

    begin(&params, query, document);
    json_write_end_object(&params);
    status = ask(query, method, &params, reply, error);
    json_writer_finish(&params);
    return status;
}

enum exit_status chart_query_scale(struct chart_query *query, const char *document, struct chart_scale *scale,
                                   struct error *error)
{
    struct message reply;
    enum exit_status status = ask_of(query, "worker.reach", document, &reply, error);

    if (status != EXIT_STATUS_DONE) return status;
    *scale = (struct chart_scale){.near = number_of(&reply, "near", 0),
                                  .far = number_of(&reply, "far", INFINITY),
                                  .length = number_of(&reply, "length", 1),
                                  .voxel = number_of(&reply, "voxel", 0)};
    message_finish(&reply);
    return status;
}

static char *truth_path(const struct chart_query *query, int samples)
{
    return samples > 1 ? xasprintf("%s.%d", query->truth_path, samples) : xstrdup(query->truth_path);
}

static void read_size(const char *document, struct chart_facts *facts)
{
    struct job job = {0};

    if (job_parse(&job, document, strlen(document), "/", NULL)) {
        facts->width_px = job.width_px;
        facts->height_px = job.height_px;
    }
    job_finish(&job);
}

enum exit_status chart_query_truth(struct chart_query *query, const char *finer, const char *coarser, int samples,
                                   double seconds, struct chart_truth_facts *facts, struct error *error)
{
    char *path = truth_path(query, samples);
    struct json_writer params = {0};
    enum exit_status status;
    struct message reply;

    begin(&params, query, finer);
    json_write_key(&params, "coarser");
    json_write_begin_object(&params);
    json_write_string_member(&params, "root", "/");
    json_write_key(&params, "document");
    json_write_raw(&params, coarser, strlen(coarser));
    json_write_end_object(&params);
    json_write_string_member(&params, "file", path);
    json_write_number_member(&params, "seconds", seconds);
    json_write_end_object(&params);
    status = ask(query, "worker.truth", &params, &reply, error);
    json_writer_finish(&params);
    free(path);
    if (status != EXIT_STATUS_DONE) return status;
    *facts =
        (struct chart_truth_facts){.facts = {.frame = query->frame}, .pixels = (int64_t)number_of(&reply, "pixels", 0)};
    read_size(finer, &facts->facts);
    copy_text(&reply, "scene", facts->facts.scene, sizeof facts->facts.scene);
    copy_text(&reply, "backend", facts->facts.backend, sizeof facts->facts.backend);
    copy_text(&reply, "renderer", facts->facts.renderer, sizeof facts->facts.renderer);
    copy_text(&reply, "truth", facts->truth, sizeof facts->truth);
    message_finish(&reply);
    return status;
}

static enum chart_outcome outcome_of(const struct message *reply)
{
    char text[16];

    copy_text(reply, "outcome", text, sizeof text);
    if (strcmp(text, "measured") == 0) return CHART_MEASURED;
    return strcmp(text, "too slow") == 0 ? CHART_TOO_SLOW : CHART_REFUSED;
}

enum exit_status chart_query_point(struct chart_query *query, const char *document,
                                   const struct chart_truth_facts *facts, int samples, double limit_s,
                                   struct chart_point *point, struct error *reason)
{
    char *path = truth_path(query, samples);
    struct json_writer params = {0};
    enum exit_status status;
    struct message reply;

    begin(&params, query, document);
    json_write_string_member(&params, "file", path);
    json_write_string_member(&params, "scene", facts->facts.scene);
    json_write_number_member(&params, "limit_s", limit_s);
    json_write_end_object(&params);
    status = ask(query, "worker.measure", &params, &reply, reason);
    json_writer_finish(&params);
    free(path);
    if (status != EXIT_STATUS_DONE) return status;
    point->outcome = outcome_of(&reply);
    point->seconds = number_of(&reply, "seconds", 0);
    point->repeats = (int64_t)number_of(&reply, "repeats", 0);
    point->error = number_of(&reply, "error", INFINITY);
    point->largest_error = number_of(&reply, "largest_error", INFINITY);
    point->pixels = (int64_t)number_of(&reply, "pixels", 0);
    copy_text(&reply, "timer", point->timer, sizeof point->timer);
    copy_text(&reply, "truth", point->truth, sizeof point->truth);
    copy_text(&reply, "reason", reason->message, sizeof reason->message);
    message_finish(&reply);
    return status;
}

enum exit_status chart_query_program(struct chart_query *query, const char *document, char hash[static HASH_TEXT_SIZE],
                                     struct error *error)
{
    struct message reply;
    enum exit_status status = ask_of(query, "worker.explain", document, &reply, error);

    if (status != EXIT_STATUS_DONE) return status;
    copy_text(&reply, "shader_hash", hash, HASH_TEXT_SIZE);
    message_finish(&reply);
    return status;
}

static bool read_plan(const struct message *reply, char **quality, struct error *error)
{
    struct json_node plans = json_node_child(&reply->body, "plans"), plan = json_node_element(&plans, 0);
    struct json_node chosen = json_node_child(&plan, "quality");

    if (!json_check_object(&chosen, error)) return false;
    *quality = json_node_format(&chosen);
    return true;
}

enum exit_status chart_query_plan(struct chart_query *query, const char *document, char **quality, struct error *error)
{
    char *frame = xasprintf("\"%lld\"", (long long)query->frame);
    char *alone = set_value(xstrdup(document), "frames", frame, error);
    struct json_writer params = {0};
    enum exit_status status = EXIT_STATUS_FAILED;
    struct message reply;

    free(frame);
    if (!alone) return status;
    begin(&params, query, alone);
    json_write_end_object(&params);
    status = ask(query, "worker.plan", &params, &reply, error);
    json_writer_finish(&params);
    free(alone);
    if (status != EXIT_STATUS_DONE) return status;
    if (!read_plan(&reply, quality, error)) status = EXIT_STATUS_FAILED;
    message_finish(&reply);
    return status;
}

void chart_strip_add(struct chart_strip *strip, char *document, char *label)
{
    strip->pictures = xrealloc(strip->pictures, (strip->count + 1) * sizeof *strip->pictures);
    strip->pictures[strip->count++] = (struct chart_strip_picture){document, label};
}

void chart_strip_finish(struct chart_strip *strip)
{
    for (size_t i = 0; i < strip->count; i++) {
        free(strip->pictures[i].document);
        free(strip->pictures[i].label);
    }
    free(strip->pictures);
    *strip = (struct chart_strip){0};
}

static void write_picture(struct json_writer *params, const struct chart_strip_picture *picture)
{
    json_write_begin_object(params);
    json_write_string_member(params, "root", "/");
    json_write_string_member(params, "label", picture->label);
    json_write_key(params, "document");
    json_write_raw(params, picture->document, strlen(picture->document));
    json_write_end_object(params);
}

enum exit_status chart_query_strip(struct chart_query *query, const struct chart_strip *strip, const char *path,
                                   struct error *error)
{
    struct json_writer params = {0};
    enum exit_status status;
    struct message reply;

    begin(&params, query, NULL);
    json_write_string_member(&params, "out", path);
    json_write_key(&params, "pictures");
    json_write_begin_array(&params);
    for (size_t i = 0; i + 1 < strip->count; i++)
        write_picture(&params, &strip->pictures[i]);
    json_write_end_array(&params);
    json_write_key(&params, "against");
    write_picture(&params, &strip->pictures[strip->count - 1]);
    json_write_end_object(&params);
    status = ask(query, "worker.error_strip", &params, &reply, error);
    json_writer_finish(&params);
    if (status == EXIT_STATUS_DONE) message_finish(&reply);
    return status;
}
