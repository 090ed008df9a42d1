// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/wire/message.h"
#include "daemon/workers/worker_report.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

// The report borrows from `message`, which the caller finishes.
static bool read_line(struct worker_report *report, struct message *message, const char *method, const char *params,
                      struct error *error)
{
    char line[1024];
    enum message_code code;

    snprintf(line, sizeof line, "{\"jsonrpc\":\"2.0\",\"method\":\"%s\",\"params\":%s}", method, params);
    assert_true(message_decode(message, line, strlen(line), &code, error));
    return worker_report_read(report, message, error);
}

static void refuse(const char *method, const char *params, const char *part)
{
    struct worker_report report;
    struct message message = {0};
    struct error error = {0};

    assert_false(read_line(&report, &message, method, params, &error));
    if (!strstr(error.message, part)) fail_msg("expected \"%s\" in \"%s\"", part, error.message);
    message_finish(&message);
}

static void texts_steer_no_terminal(void **state)
{
    struct worker_report report;
    struct message message = {0};

    assert_true(read_line(&report, &message, "worker.failed", "{\"error\":\"red \\u001b[31m and \\u009b31m\"}", NULL));
    assert_string_equal(report.error, "red ?[31m and ??31m");
    message_finish(&message);
    assert_true(read_line(&report, &message, "worker.ready",
                          "{\"backend\":\"egl\",\"vendor\":\"a\\u0007\",\"renderer\":\"b\\u001b\",\"version\":\"c\"}",
                          NULL));
    assert_string_equal(report.vendor, "a?");
    assert_string_equal(report.renderer, "b?");
    message_finish(&message);
}

static void a_finished_frame_keeps_a_file_number_beyond_2_to_the_53(void **state)
{
    struct worker_report report;
    struct message message = {0};

    assert_true(read_line(
        &report, &message, "frame.finished",
        "{\"job\":3,\"frame\":7,\"attempt\":2,\"inode\":\"18446744073709551557\",\"size_bytes\":1234,"
        "\"hash\":\"00112233445566778899aabbccddeeff\",\"render_s\":1.5,\"encode_s\":0.25,\"audit_s\":0.5,\"weight\":2."
        "5,\"later\":1,"
        "\"audit\":\"reference\",\"measured_error\":0.25,\"error95\":0.5,\"audit_rays\":9,\"method\":\"gauss\"}",
        NULL));
    assert_int_equal(report.kind, WORKER_REPORT_FINISHED);
    assert_int_equal(report.job, 3);
    assert_int_equal(report.frame, 7);
    assert_int_equal(report.attempt, 2);
    assert_true(report.file.inode == 18446744073709551557U);
    assert_int_equal(report.file.size_bytes, 1234);
    assert_string_equal(report.file.hash, "00112233445566778899aabbccddeeff");
    assert_true(report.render_s == 1.5 && report.encode_s == 0.25);
    assert_true(report.audit_s == 0.5 && report.weight == 2.5);
    assert_string_equal(report.accuracy.method, "gauss");
    assert_true(report.accuracy.error == 0.25 && !report.accuracy.has_cut_share);
    message_finish(&message);
}

static void an_unknown_fault_is_an_error(void **state)
{
    struct worker_report report;
    struct message message = {0};

    assert_true(read_line(&report, &message, "frame.failed",
                          "{\"job\":1,\"frame\":0,\"attempt\":1,\"fault\":\"output\",\"error\":\"full\"}", NULL));
    assert_int_equal(report.fault, RETRY_FAULT_OUTPUT);
    assert_string_equal(report.error, "full");
    message_finish(&message);
    refuse("frame.failed", "{\"job\":1,\"frame\":0,\"attempt\":1,\"fault\":\"mood\",\"error\":\"x\"}", "fault");
}

static void planning_is_reported_for_a_frame(void **state)
{
    struct worker_report report;
    struct message message = {0};

    assert_true(read_line(&report, &message, "frame.planning", "{\"job\":1,\"frame\":2,\"attempt\":3}", NULL));
    assert_int_equal(report.kind, WORKER_REPORT_PLANNING);
    assert_int_equal(report.frame, 2);
    message_finish(&message);
    assert_true(
        read_line(&report, &message, "frame.planned", "{\"job\":1,\"frame\":2,\"attempt\":3,\"frames\":48}", NULL));
    assert_int_equal(report.planned_frames, 48);
    assert_true(report.foretold_s == 0.0);
    message_finish(&message);
    assert_true(read_line(&report, &message, "frame.planned",
                          "{\"job\":1,\"frame\":2,\"attempt\":3,\"frames\":48,\"render_s\":7.5}", NULL));
    assert_true(report.foretold_s == 7.5);
    message_finish(&message);
    assert_false(
        read_line(&report, &message, "frame.planned", "{\"job\":1,\"frame\":2,\"attempt\":3,\"render_s\":-1}", NULL));
    message_finish(&message);
    assert_true(
        read_line(&report, &message, "frame.phase", "{\"job\":1,\"frame\":2,\"attempt\":3,\"phase\":\"audit\"}", NULL));
    assert_true(report.kind == WORKER_REPORT_PHASE && report.phase == FRAME_PHASE_AUDIT && report.phase_progress < 0.0);
    message_finish(&message);
    assert_true(read_line(&report, &message, "frame.planned", "{\"job\":1,\"frame\":2,\"attempt\":3}", NULL));
    assert_int_equal(report.planned_frames, 0);
    assert_int_equal(report.kind, WORKER_REPORT_PLANNED);
    message_finish(&message);
}

static void an_unknown_method_is_no_error(void **state)
{
    struct worker_report report;
    struct message message = {0};

    assert_true(read_line(&report, &message, "worker.sings", "{}", NULL));
    assert_int_equal(report.kind, WORKER_REPORT_UNKNOWN);
    message_finish(&message);
}

static void a_device_may_have_no_uuid(void **state)
{
    struct worker_report report;
    struct message message = {0};

    assert_true(read_line(&report, &message, "worker.ready",
                          "{\"pid\":1,\"backend\":\"egl\",\"vendor\":\"v\",\"renderer\":\"r\",\"version\":\"4.5\","
                          "\"device_uuid\":null}",
                          NULL));
    assert_null(report.device_uuid);
    assert_string_equal(report.renderer, "r");
    message_finish(&message);
}

static void missing_and_wrong_members_are_named(void **state)
{
    refuse("frame.started", "{\"job\":1,\"frame\":0}", "frame.started: params.attempt");
    refuse("frame.started", "{\"job\":0,\"frame\":0,\"attempt\":1}", "params.job");
    refuse("frame.rendered", "{\"job\":1,\"frame\":-1,\"attempt\":1}", "params.frame");
    refuse("worker.beat", "{\"progress\":\"fast\"}", "params.progress");
    refuse("worker.ready", "{\"pid\":1}", "params.backend");
    refuse("frame.finished",
           "{\"job\":1,\"frame\":0,\"attempt\":1,\"inode\":\"-5\",\"size_bytes\":1,\"hash\":\"a\",\"render_s\":0,"
           "\"encode_s\":0}",
           "params.inode");
    refuse("frame.skipped",
           "{\"job\":1,\"frame\":0,\"attempt\":1,\"size_bytes\":1,"
           "\"hash\":\"00112233445566778899aabbccddeeff0\"}",
           "params.hash");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texts_steer_no_terminal),
        cmocka_unit_test(a_finished_frame_keeps_a_file_number_beyond_2_to_the_53),
        cmocka_unit_test(an_unknown_fault_is_an_error),
        cmocka_unit_test(planning_is_reported_for_a_frame),
        cmocka_unit_test(an_unknown_method_is_no_error),
        cmocka_unit_test(a_device_may_have_no_uuid),
        cmocka_unit_test(missing_and_wrong_members_are_named),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
