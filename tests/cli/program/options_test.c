// SPDX-License-Identifier: Apache-2.0
#include "cli/program/options.h"

#include "core/base/error.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const uint64_t every = ~UINT64_C(0);

#define ARGUMENTS(...) (const char *const[]){__VA_ARGS__}, sizeof((const char *const[]){__VA_ARGS__}) / sizeof(char *)

static void assert_refused(uint64_t accepted, const char *const arguments[], size_t count, const char *expected)
{
    struct options options;
    struct error error = {0};

    assert_false(options_parse(&options, accepted, arguments, count, &error));
    assert_string_equal(error.message, expected);
}

static void options_and_operands_come_in_any_order(void **state)
{
    struct options options;

    assert_true(options_parse(
        &options, every, ARGUMENTS("job.json", "--wait", "--set", "a=1", "-", "--set=b=2", "--priority", "7", "--json"),
        NULL));
    assert_int_equal(options.operand_count, 2);
    assert_string_equal(options.operands[0], "job.json");
    assert_string_equal(options.operands[1], "-");
    assert_int_equal(options.set_count, 2);
    assert_string_equal(options.sets[0], "a=1");
    assert_string_equal(options.sets[1], "b=2");
    assert_int_equal(options.priority, 7);
    assert_true(options.wait && options.json && !options.watch);
    options_finish(&options);
}

static void frames_have_two_names_and_are_checked(void **state)
{
    struct options options;

    assert_true(options_parse(&options, every, ARGUMENTS("--frames", "1-9x2"), NULL));
    assert_string_equal(options.range, "1-9x2");
    options_finish(&options);
    assert_true(options_parse(&options, every, ARGUMENTS("--range", "7"), NULL));
    assert_string_equal(options.range, "7");
    options_finish(&options);
    assert_refused(every, ARGUMENTS("--frames", "1..9"), "--frames: expected \"1-100x2\", got \"1..9\"");
    assert_true(options_parse(&options, OPTION_BIT(OPTION_FRAME), ARGUMENTS("--frames", "7"), NULL));
    assert_int_equal(options.frame, 7);
    options_finish(&options);
}

static void values_may_begin_with_a_dash(void **state)
{
    struct options options;

    assert_true(options_parse(&options, every, ARGUMENTS("--exposure", "-1.5", "--", "--wait"), NULL));
    assert_true(options.exposure == -1.5);
    assert_int_equal(options.operand_count, 1);
    assert_string_equal(options.operands[0], "--wait");
    assert_false(options.wait);
    options_finish(&options);
}

static void what_is_not_given_is_told_apart(void **state)
{
    struct options options;

    assert_true(options_parse(&options, every, NULL, 0, NULL));
    assert_int_equal(options.priority, -1);
    assert_int_equal(options.frame, -1);
    assert_true(isnan(options.exposure) && isnan(options.fps));
    assert_null(options.out);
    options_finish(&options);
}

static void unknown_options_name_the_nearest(void **state)
{
    assert_refused(every, ARGUMENTS("--bakend", "egl"), "unknown option --bakend, did you mean --backend?");
    assert_refused(every, ARGUMENTS("-x"), "unknown option -x");
}

static void options_of_other_verbs_are_unknown(void **state)
{
    assert_refused(OPTION_BIT(OPTION_JSON), ARGUMENTS("--columns", "3"), "unknown option --columns");
}

static void wrong_values_say_what_was_expected(void **state)
{
    assert_refused(every, ARGUMENTS("--priority", "201"), "--priority: expected an integer in [0, 200], got \"201\"");
    assert_refused(every, ARGUMENTS("--priority", "7x"), "--priority: expected an integer in [0, 200], got \"7x\"");
    assert_refused(every, ARGUMENTS("--priority="), "--priority: expected an integer in [0, 200], got \"\"");
    assert_refused(every, ARGUMENTS("--fps", "nan"), "--fps: expected a number, got \"nan\"");
    assert_refused(every, ARGUMENTS("--backend", "none"),
                   "--backend: expected auto, egl, osmesa or software, got \"none\"");
    assert_refused(every, ARGUMENTS("--json=yes"), "--json takes no value");
    assert_refused(every, ARGUMENTS("--out"), "--out: expected PATH after it");
}

static void job_ids_are_positive_integers(void **state)
{
    static const char *const wrong[] = {"", "0", "-1", "7a", "1.5", "99999999999999999999"};
    int64_t id;

    assert_true(options_parse_id("7", &id, NULL));
    assert_int_equal(id, 7);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        if (options_parse_id(wrong[i], &id, NULL)) fail_msg("%s was taken", wrong[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(options_and_operands_come_in_any_order),
        cmocka_unit_test(frames_have_two_names_and_are_checked),
        cmocka_unit_test(values_may_begin_with_a_dash),
        cmocka_unit_test(what_is_not_given_is_told_apart),
        cmocka_unit_test(unknown_options_name_the_nearest),
        cmocka_unit_test(options_of_other_verbs_are_unknown),
        cmocka_unit_test(wrong_values_say_what_was_expected),
        cmocka_unit_test(job_ids_are_positive_integers),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
