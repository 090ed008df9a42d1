// SPDX-License-Identifier: Apache-2.0
#include "bench/stub_report.h"

#include "core/json/json_write.h"
#include "core/wire/message.h"

#include <string.h>
#include <unistd.h>

void stub_report_begin(struct json_writer *out, const char *method, const struct stub_frame *frame)
{
    message_begin_notification(out, method);
    json_write_begin_object(out);
    json_write_integer_member(out, "job", frame->job);
    json_write_integer_member(out, "frame", frame->frame);
    json_write_integer_member(out, "attempt", frame->attempt);
}

void stub_report_end(struct json_writer *out)
{
    json_write_end_object(out);
    message_end(out);
}

void stub_report_ready(struct json_writer *out)
{
    message_begin_notification(out, "worker.ready");
    json_write_begin_object(out);
    json_write_integer_member(out, "pid", getpid());
    json_write_string_member(out, "backend", "stub");
    json_write_string_member(out, "vendor", "marchd");
    json_write_string_member(out, "renderer", "none");
    json_write_string_member(out, "version", MARCHD_VERSION);
    json_write_string_member(out, "device_uuid", NULL);
    stub_report_end(out);
}

void stub_report_unable(struct json_writer *out)
{
    message_begin_notification(out, "worker.failed");
    json_write_begin_object(out);
    json_write_string_member(out, "error", "there is no GL context to be had here");
    stub_report_end(out);
}

void stub_report_skipped(struct json_writer *out, const struct stub_frame *frame, int64_t size_bytes, const char *hash)
{
    stub_report_begin(out, "frame.skipped", frame);
    json_write_integer_member(out, "size_bytes", size_bytes);
    json_write_string_member(out, "hash", hash);
    stub_report_end(out);
}

void stub_report_failed(struct json_writer *out, const struct stub_frame *frame, const char *fault, const char *error)
{
    stub_report_begin(out, "frame.failed", frame);
    json_write_string_member(out, "fault", fault);
    json_write_string_member(out, "error", error);
    stub_report_end(out);
}

static void begin_plan_report(struct json_writer *out, const char *method, const struct stub_frame *frame)
{
    stub_report_begin(out, method, frame);
    json_write_string_member(out, "key", "00112233445566778899aabbccddeeff");
}

void stub_report_plan_wanted(struct json_writer *out, const struct stub_frame *frame)
{
    begin_plan_report(out, "plan.ask", frame);
    stub_report_end(out);
}

void stub_report_plan_made(struct json_writer *out, const struct stub_frame *frame, bool is_bad)
{
    static const char good[] =
        "{\"quality\":{\"method\":\"midpoint\",\"step\":0.05,\"light_step\":0.05,\"samples\":1},\"why\":\"stub\","
        "\"scouts\":[],\"pilot\":{\"quality\":{\"method\":\"midpoint\",\"step\":0.01,\"light_step\":0.01,"
        "\"samples\":1},\"pixels\":576,\"frames\":[],\"change\":0,\"samples\":[]}}";
    static const char bad[] = "{\"quality\":{\"method\":\"midpoint\",\"step\":0,\"light_step\":0.05},\"why\":\"\"}";
    const char *plan = is_bad ? bad : good;

    begin_plan_report(out, "plan.made", frame);
    json_write_key(out, "plan");
    json_write_raw(out, plan, strlen(plan));
    stub_report_end(out);
}
