// SPDX-License-Identifier: Apache-2.0
#include "daemon/workers/worker_report.h"

#include "core/base/error.h"
#include "core/base/log.h"
#include "core/job/frame_range.h"
#include "core/wire/message.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Other users see these texts: control characters must not reach their terminals.
static bool read_plain(const struct json_node *node, const char **text, struct error *error)
{
    if (!json_read_string(node, text, error)) return false;
    log_disarm((char *)*text);
    return true;
}

static bool read_text(const struct json_node *body, const char *key, const char **text, struct error *error)
{
    struct json_node node = json_node_child(body, key);

    return read_plain(&node, text, error);
}

// Reads a member that may be null or missing.
static bool read_maybe_text(const struct json_node *body, const char *key, const char **text, struct error *error)
{
    struct json_node node = json_node_child(body, key);

    *text = NULL;
    if (json_node_is_absent(&node) || json_node_type(&node) == JSON_NULL) return true;
    return read_plain(&node, text, error);
}

static bool read_integer(const struct json_node *body, const char *key, int64_t min, int64_t max, int64_t *integer,
                         struct error *error)
{
    struct json_node node = json_node_child(body, key);

    return json_read_integer(&node, min, max, integer, error);
}

static bool read_seconds(const struct json_node *body, const char *key, double *seconds, struct error *error)
{
    struct json_node node = json_node_child(body, key);

    return json_read_number(&node, 0, 1e9, seconds, error);
}

static bool read_ready(struct worker_report *report, const struct json_node *body, struct error *error)
{
    return read_text(body, "backend", &report->backend, error) && read_text(body, "vendor", &report->vendor, error) &&
           read_text(body, "renderer", &report->renderer, error) &&
           read_text(body, "version", &report->version, error) &&
           read_maybe_text(body, "device_uuid", &report->device_uuid, error) &&
           read_maybe_text(body, "sandbox", &report->sandbox, error);
}

static bool read_beat(struct worker_report *report, const struct json_node *body, struct error *error)
{
    struct json_node node = json_node_child(body, "progress");

    return json_read_number(&node, 0, 1e18, &report->progress, error);
}

static bool read_frame(struct worker_report *report, const struct json_node *body, struct error *error)
{
    int64_t frame, attempt;

    if (!read_integer(body, "job", 1, INT64_MAX, &report->job, error)) return false;
    if (!read_integer(body, "frame", 0, FRAME_NUMBER_LIMIT - 1, &frame, error)) return false;
    if (!read_integer(body, "attempt", 1, INT32_MAX, &attempt, error)) return false;
    report->frame = (int32_t)frame;
    report->attempt = (int32_t)attempt;
    return true;
}

// An inode is text: some file systems use numbers beyond the range of JSON numbers.
static bool read_inode(const struct json_node *body, uint64_t *inode, struct error *error)
{
    struct json_node node = json_node_child(body, "inode");
    const char *text;
    char *end = NULL;

    if (!json_read_string(&node, &text, error)) return false;
    errno = 0;
    *inode = strtoull(text, &end, 10);
    if (errno == 0 && text[0] >= '0' && text[0] <= '9' && !*end) return true;
    return json_fail_expected(&node, error, "a file number in decimal digits");
}

static bool read_file(struct published_file *file, const struct json_node *body, struct error *error)
{
    struct json_node node = json_node_child(body, "hash");
    const char *hash;
    size_t length;
    int64_t size_bytes;

    if (!read_integer(body, "size_bytes", 0, (int64_t)1 << 53, &size_bytes, error)) return false;
    if (!json_read_string(&node, &hash, error)) return false;
    length = strlen(hash);
    if (length >= HASH_TEXT_SIZE) return json_fail_expected(&node, error, "a hash of 32 hexadecimal digits");
    file->size_bytes = (uint64_t)size_bytes;
    memcpy(file->hash, hash, length + 1);
    return true;
}

// A worker that compares no pixels leaves audit_s out, one that plans nothing the weight, and one that renders `found`.
static bool read_optional(struct worker_report *report, const struct json_node *body, struct error *error)
{
    struct json_node seconds = json_node_child(body, "audit_s"), weight = json_node_child(body, "weight");
    struct json_node found = json_node_child(body, "found");

    report->weight = 1.0;
    return (json_node_is_absent(&found) || json_read_bool(&found, &report->is_found, error)) &&
           (json_node_is_absent(&seconds) || json_read_number(&seconds, 0, 1e9, &report->audit_s, error)) &&
           (json_node_is_absent(&weight) || json_read_number(&weight, 0, 1e9, &report->weight, error));
}

static bool read_planned(struct worker_report *report, const struct json_node *body, struct error *error)
{
    struct json_node frames = json_node_child(body, "frames"), seconds = json_node_child(body, "render_s");

    return read_frame(report, body, error) &&
           (json_node_is_absent(&frames) ||
            json_read_integer(&frames, 1, FRAME_COUNT_LIMIT, &report->planned_frames, error)) &&
           (json_node_is_absent(&seconds) || json_read_number(&seconds, 0.0, HUGE_VAL, &report->foretold_s, error));
}

static bool read_phase(struct worker_report *report, const struct json_node *body, struct error *error)
{
    struct json_node phase = json_node_child(body, "phase"), progress = json_node_child(body, "progress");
    int choice;

    if (!read_frame(report, body, error) || !json_read_enum(&phase, frame_phase_names, &choice, error)) return false;
    report->phase = (enum frame_phase)choice;
    report->phase_progress = -1.0;
    return json_node_is_absent(&progress) || json_read_number(&progress, 0.0, 1.0, &report->phase_progress, error);
}

static bool read_plan_wanted(struct worker_report *report, const struct json_node *body, struct error *error)
{
    struct json_node node = json_node_child(body, "key");

    if (!read_frame(report, body, error) || !json_read_string(&node, &report->key, error)) return false;
    if (strlen(report->key) == HASH_TEXT_SIZE - 1 && strspn(report->key, "0123456789abcdef") == HASH_TEXT_SIZE - 1)
        return true;
    return json_fail_expected(&node, error, "a hash of 32 hexadecimal digits");
}

static bool read_plan_made(struct worker_report *report, const struct json_node *body, struct error *error)
{
    struct json_node missed = json_node_child(body, "missed");

    report->plan = json_node_child(body, "plan");
    return read_plan_wanted(report, body, error) &&
           (json_node_is_absent(&missed) || json_read_integer(&missed, 1, INT64_MAX, &report->missed, error)) &&
           json_check_object(&report->plan, error);
}

static bool read_finished(struct worker_report *report, const struct json_node *body, struct error *error)
{
    return read_frame(report, body, error) && read_file(&report->file, body, error) &&
           read_inode(body, &report->file.inode, error) && read_seconds(body, "render_s", &report->render_s, error) &&
           read_seconds(body, "encode_s", &report->encode_s, error) && read_optional(report, body, error) &&
           frame_accuracy_read(&report->accuracy, body, error);
}

static bool read_skipped(struct worker_report *report, const struct json_node *body, struct error *error)
{
    return read_frame(report, body, error) && read_file(&report->file, body, error) &&
           frame_accuracy_read(&report->accuracy, body, error);
}

static bool read_failed(struct worker_report *report, const struct json_node *body, struct error *error)
{
    struct json_node node = json_node_child(body, "fault");
    int fault;

    if (!read_frame(report, body, error) || !json_read_enum(&node, retry_fault_names, &fault, error)) return false;
    report->fault = (enum retry_fault)fault;
    return read_text(body, "error", &report->error, error);
}

static bool read_unable(struct worker_report *report, const struct json_node *body, struct error *error)
{
    struct json_node node = json_node_child(body, "fault");
    int fault = RETRY_FAULT_WORKER;

    if (!json_node_is_absent(&node) && !json_read_enum(&node, retry_fault_names, &fault, error)) return false;
    report->fault = (enum retry_fault)fault;
    return read_text(body, "error", &report->error, error);
}

static const struct report_method {
    const char *name;
    enum worker_report_kind kind;
    bool (*read)(struct worker_report *report, const struct json_node *body, struct error *error);
} methods[] = {
    {"frame.skipped", WORKER_REPORT_SKIPPED, read_skipped},
    {"frame.started", WORKER_REPORT_STARTED, read_frame},
    {"frame.rendered", WORKER_REPORT_RENDERED, read_frame},
    {"frame.finished", WORKER_REPORT_FINISHED, read_finished},
    {"frame.failed", WORKER_REPORT_FAILED, read_failed},
    {"frame.dropped", WORKER_REPORT_DROPPED, read_frame},
    {"worker.beat", WORKER_REPORT_BEAT, read_beat},
    {"worker.ready", WORKER_REPORT_READY, read_ready},
    {"worker.failed", WORKER_REPORT_UNABLE, read_unable},
    {"frame.planning", WORKER_REPORT_PLANNING, read_frame},
    {"frame.planned", WORKER_REPORT_PLANNED, read_planned},
    {"frame.phase", WORKER_REPORT_PHASE, read_phase},
    {"plan.ask", WORKER_REPORT_PLAN_WANTED, read_plan_wanted},
    {"plan.made", WORKER_REPORT_PLAN_MADE, read_plan_made},
};

bool worker_report_read(struct worker_report *report, const struct message *message, struct error *error)
{
    *report = (struct worker_report){.kind = WORKER_REPORT_UNKNOWN};
    if (!message->method) return true;
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++) {
        if (strcmp(methods[i].name, message->method) != 0) continue;
        report->kind = methods[i].kind;
        if (methods[i].read(report, &message->body, error)) return true;
        error_prefix(error, "%s", message->method);
        return false;
    }
    return true;
}
