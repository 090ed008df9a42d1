// SPDX-License-Identifier: Apache-2.0
#include "core/wire/frame_accuracy.h"

#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static bool read_text(struct frame_accuracy *accuracy, const char *text, struct error *error)
{
    struct cJSON *root = NULL;
    struct json_node node;
    bool ok;

    assert_true(json_parse(&root, text, strlen(text), error));
    node = json_node_root(root);
    ok = frame_accuracy_read(accuracy, &node, error);
    json_delete(root);
    return ok;
}

static void assert_written(const struct frame_accuracy *accuracy, const char *text)
{
    struct json_writer writer = {0};

    json_write_begin_object(&writer);
    frame_accuracy_write(accuracy, &writer);
    json_write_end_object(&writer);
    assert_string_equal(writer.text, text);
    json_writer_finish(&writer);
}

static const char all[] = "{\"audit\":\"step_halving\",\"measured_error\":0.0078125,\"error95\":0.015625,"
                          "\"audit_rays\":64,\"method\":\"cached\",\"plan\":7,\"cut_share\":0.25,\"traced\":0.0625}";

static void what_is_written_is_read(void **state)
{
    struct frame_accuracy accuracy;

    assert_true(read_text(&accuracy, all, NULL));
    assert_string_equal(accuracy.audit, "step_halving");
    assert_true(accuracy.error == 0.0078125 && accuracy.error95 == 0.015625);
    assert_int_equal(accuracy.audit_rays, 64);
    assert_string_equal(accuracy.method, "cached");
    assert_int_equal(accuracy.plan, 7);
    assert_true(accuracy.has_cut_share && accuracy.cut_share == 0.25 && accuracy.traced == 0.0625);
    assert_written(&accuracy, all);
}

static void a_missed_tolerance_is_told(void **state)
{
    static const char missed[] = "{\"audit\":\"reference\",\"measured_error\":0.5,\"error95\":0.75,"
                                 "\"audit_rays\":64,\"method\":\"cached\",\"missed\":true}";
    struct frame_accuracy accuracy;

    assert_true(read_text(&accuracy, missed, NULL));
    assert_true(accuracy.is_missed);
    assert_written(&accuracy, missed);
    assert_true(read_text(&accuracy, all, NULL));
    assert_false(accuracy.is_missed);
}

static void what_is_not_known_is_absent(void **state)
{
    struct frame_accuracy accuracy = {.has_cut_share = true, .traced = 1};

    assert_true(read_text(&accuracy, "{\"frame\":1,\"audit\":null,\"cut_share\":null,\"traced\":null}", NULL));
    assert_string_equal(accuracy.audit, "");
    assert_false(accuracy.has_cut_share);
    assert_written(&accuracy, "{}");
}

static void assert_refused(const char *text, const char *place)
{
    struct frame_accuracy accuracy;
    struct error error = {0};

    assert_false(read_text(&accuracy, text, &error));
    if (!strstr(error.message, place)) fail_msg("expected \"%s\" in \"%s\"", place, error.message);
    assert_written(&accuracy, "{}");
}

static void an_audit_is_whole_or_refused(void **state)
{
    assert_refused("{\"audit\":\"guess\",\"measured_error\":0,\"error95\":0,\"audit_rays\":1,\"method\":\"m\"}",
                   "audit");
    assert_refused("{\"audit\":\"reference\",\"error95\":0,\"audit_rays\":1,\"method\":\"m\"}", "measured_error");
    assert_refused("{\"audit\":\"reference\",\"measured_error\":-1,\"error95\":0,\"audit_rays\":1,\"method\":\"m\"}",
                   "measured_error");
    assert_refused("{\"audit\":\"reference\",\"measured_error\":0,\"audit_rays\":1,\"method\":\"m\"}", "error95");
    assert_refused("{\"audit\":\"reference\",\"measured_error\":0,\"error95\":0,\"method\":\"m\"}", "audit_rays");
    assert_refused("{\"audit\":\"reference\",\"measured_error\":0,\"error95\":0,\"audit_rays\":1}", "method");
    assert_refused("{\"audit\":\"reference\",\"measured_error\":0,\"error95\":0,\"audit_rays\":1,"
                   "\"method\":\"a name that is too long to be one\"}",
                   "method");
    assert_refused("{\"cut_share\":1.5}", "cut_share");
    assert_refused("{\"traced\":1.5}", "traced");
}

static void assert_described(double error, double error95, const char *expected)
{
    const struct frame_accuracy accuracy = {.audit = "reference", .error = error, .error95 = error95};
    char text[FRAME_ACCURACY_PHRASE_SIZE];

    frame_accuracy_describe(&accuracy, text);
    assert_string_equal(text, expected);
}

// Measured between two random halves, an error may come out as nothing.
static void no_estimate_is_no_exact_frame(void **state)
{
    assert_described(0.005, 0.0075, "0.5 % (95 %: below 0.75 %)");
    assert_described(0.0, 0.0075, "at most 0.75 % (with 95 %)");
    assert_described(0.0, 0.0, "0 % (95 %: below 0 %)");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_written_is_read),      cmocka_unit_test(a_missed_tolerance_is_told),
        cmocka_unit_test(what_is_not_known_is_absent),  cmocka_unit_test(no_estimate_is_no_exact_frame),
        cmocka_unit_test(an_audit_is_whole_or_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
