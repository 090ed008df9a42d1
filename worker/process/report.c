// SPDX-License-Identifier: Apache-2.0
#include "worker/process/report.h"

#include "core/base/log.h"
#include "core/job/plan_json.h"
#include "core/json/json_write.h"
#include "core/wire/frame_accuracy.h"
#include "core/wire/message.h"
#include "core/wire/publish.h"
#include "worker/gl/gl_context.h"
#include "worker/process/assignment.h"
#include "worker/process/connection.h"

#include <inttypes.h>
#include <stdio.h>
#include <unistd.h>

static void begin(struct json_writer *writer, const char *method)
{
    message_begin_notification(writer, method);
    json_write_begin_object(writer);
}

static void begin_frame(struct json_writer *writer, const char *method, int64_t job, int32_t frame, int attempt)
{
    begin(writer, method);
    json_write_integer_member(writer, "job", job);
    json_write_integer_member(writer, "frame", frame);
    json_write_integer_member(writer, "attempt", attempt);
}

static void send_and_finish(struct connection *connection, struct json_writer *writer)
{
    json_write_end_object(writer);
    message_end(writer);
    connection_send(connection, writer);
    json_writer_finish(writer);
}

void report_ready(struct connection *connection, const struct gl_context_facts *facts, const char *sandbox)
{
    struct json_writer writer = {0};

    begin(&writer, "worker.ready");
    json_write_integer_member(&writer, "pid", getpid());
    json_write_string_member(&writer, "backend", facts ? facts->backend : "none");
    json_write_string_member(&writer, "vendor", facts ? facts->vendor : NULL);
    json_write_string_member(&writer, "renderer", facts ? facts->renderer : NULL);
    json_write_string_member(&writer, "version", facts ? facts->version : NULL);
    json_write_string_member(&writer, "device_uuid", facts && facts->device_uuid[0] ? facts->device_uuid : NULL);
    json_write_string_member(&writer, "sandbox", sandbox);
    send_and_finish(connection, &writer);
}

void report_unable(struct connection *connection, const char *fault, const char *reason)
{
    struct json_writer writer = {0};

    log_error("%s", reason);
    begin(&writer, "worker.failed");
    json_write_string_member(&writer, "fault", fault);
    json_write_string_member(&writer, "error", reason);
    send_and_finish(connection, &writer);
}

void report_beat(struct connection *connection, uint64_t progress)
{
    struct json_writer writer = {0};

    begin(&writer, "worker.beat");
    json_write_integer_member(&writer, "progress", (int64_t)progress);
    send_and_finish(connection, &writer);
}

void report_phase(struct connection *connection, const struct report_doing *doing)
{
    struct json_writer writer = {0};

    if (doing->phase == FRAME_PHASE_NONE) return;
    begin_frame(&writer, "frame.phase", doing->job, doing->frame, doing->attempt);
    json_write_string_member(&writer, "phase", frame_phase_names[doing->phase]);
    if (doing->progress >= 0.0) json_write_number_member(&writer, "progress", doing->progress);
    send_and_finish(connection, &writer);
}

void report_part(struct connection *connection, int64_t done, int64_t count, double share)
{
    struct json_writer writer = {0};

    begin(&writer, "request.progress");
    json_write_integer_member(&writer, "done", done);
    json_write_integer_member(&writer, "count", count);
    json_write_number_member(&writer, "share", share);
    send_and_finish(connection, &writer);
}

static void report_plain(struct connection *connection, const char *method, const struct assignment_frame *frame)
{
    struct json_writer writer = {0};

    begin_frame(&writer, method, frame->job->id, frame->frame, frame->attempt);
    send_and_finish(connection, &writer);
}

void report_started(struct connection *connection, const struct assignment_frame *frame)
{
    report_plain(connection, "frame.started", frame);
}

void report_planning(struct connection *connection, const struct assignment_frame *frame)
{
    report_plain(connection, "frame.planning", frame);
}

void report_planned(struct connection *connection, const struct assignment_frame *frame, int64_t frame_count,
                    double render_s)
{
    struct json_writer writer = {0};

    begin_frame(&writer, "frame.planned", frame->job->id, frame->frame, frame->attempt);
    json_write_integer_member(&writer, "frames", frame_count);
    if (render_s > 0.0) json_write_number_member(&writer, "render_s", render_s);
    send_and_finish(connection, &writer);
}

void report_plan_wanted(struct connection *connection, const struct assignment_frame *frame, const char *key)
{
    struct json_writer writer = {0};

    begin_frame(&writer, "plan.ask", frame->job->id, frame->frame, frame->attempt);
    json_write_string_member(&writer, "key", key);
    send_and_finish(connection, &writer);
}

void report_plan_made(struct connection *connection, const struct assignment_frame *frame,
                      const struct report_plan *made)
{
    struct json_writer writer = {0};

    begin_frame(&writer, "plan.made", frame->job->id, frame->frame, frame->attempt);
    json_write_string_member(&writer, "key", made->key);
    if (made->missed > 0) json_write_integer_member(&writer, "missed", made->missed);
    json_write_key(&writer, "plan");
    plan_to_json(&writer, made->plan, &frame->job->job);
    send_and_finish(connection, &writer);
}

void report_rendered(struct connection *connection, const struct assignment_frame *frame)
{
    report_plain(connection, "frame.rendered", frame);
}

void report_finished(struct connection *connection, const struct assignment_frame *frame,
                     const struct report_result *result)
{
    struct json_writer writer = {0};
    char inode[24]; // as text: a JSON number may not hold it

    snprintf(inode, sizeof inode, "%" PRIu64, result->file->inode);
    begin_frame(&writer, "frame.finished", frame->job->id, frame->frame, frame->attempt);
    json_write_string_member(&writer, "inode", inode);
    json_write_integer_member(&writer, "size_bytes", (int64_t)result->file->size_bytes);
    json_write_string_member(&writer, "hash", result->file->hash);
    json_write_number_member(&writer, "render_s", result->render_s);
    json_write_number_member(&writer, "encode_s", result->encode_s);
    if (result->audit_s > 0) json_write_number_member(&writer, "audit_s", result->audit_s);
    if (result->weight > 0) json_write_number_member(&writer, "weight", result->weight);
    if (result->is_found) json_write_bool_member(&writer, "found", true);
    frame_accuracy_write(result->accuracy, &writer);
    send_and_finish(connection, &writer);
}

void report_skipped(struct connection *connection, const struct assignment_frame *frame,
                    const struct report_result *result)
{
    struct json_writer writer = {0};

    begin_frame(&writer, "frame.skipped", frame->job->id, frame->frame, frame->attempt);
    json_write_integer_member(&writer, "size_bytes", (int64_t)result->file->size_bytes);
    json_write_string_member(&writer, "hash", result->file->hash);
    frame_accuracy_write(result->accuracy, &writer);
    send_and_finish(connection, &writer);
}

void report_dropped(struct connection *connection, const struct assignment_dropped *dropped)
{
    struct json_writer writer = {0};

    begin_frame(&writer, "frame.dropped", dropped->job, dropped->frame, dropped->attempt);
    send_and_finish(connection, &writer);
}

void report_frame_failed(struct connection *connection, const struct assignment_frame *frame, enum report_fault fault,
                         const char *reason)
{
    static const char *const names[] = {"job", "frame", "worker", "output", "root", "endless", "cut", "missed"};
    struct json_writer writer = {0};

    // At debug level, because the program that assigned the frame tells the user.
    log_debug("job %" PRId64 " frame %d attempt %d (%s): %s", frame->job->id, frame->frame, frame->attempt,
              names[fault], reason);
    begin_frame(&writer, "frame.failed", frame->job->id, frame->frame, frame->attempt);
    json_write_string_member(&writer, "fault", names[fault]);
    json_write_string_member(&writer, "error", reason);
    send_and_finish(connection, &writer);
}
