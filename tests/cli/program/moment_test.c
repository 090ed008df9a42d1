// SPDX-License-Identifier: Apache-2.0
#include "cli/program/moment.h"

#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

enum { NOW = 1800000000 };

static void ages_are_before_now(void **state)
{
    static const struct {
        const char *text;
        int64_t age_s;
    } ages[] = {{"0s", 0}, {"90s", 90}, {"15m", 900}, {"12h", 43200}, {"30d", 2592000}, {"2w", 1209600}};

    for (size_t i = 0; i < sizeof ages / sizeof *ages; i++) {
        int64_t unix_s;

        assert_true(moment_parse(ages[i].text, NOW, &unix_s, NULL));
        assert_int_equal(unix_s, NOW - ages[i].age_s);
    }
}

static void an_age_beyond_all_time_is_the_beginning(void **state)
{
    int64_t unix_s;

    assert_true(moment_parse("999999999w", NOW, &unix_s, NULL));
    assert_int_equal(unix_s, 0);
}

static void dates_are_local(void **state)
{
    int64_t unix_s;

    setenv("TZ", "UTC-2", 1); // two hours before UTC's
    tzset();
    assert_true(moment_parse("2026-03-01", NOW, &unix_s, NULL));
    assert_int_equal(unix_s, 1772323200 - 7200);
    assert_true(moment_parse("2026-03-01T18:30", NOW, &unix_s, NULL));
    assert_int_equal(unix_s, 1772323200 - 7200 + 18 * 3600 + 30 * 60);
}

static void anything_else_is_refused(void **state)
{
    static const char *const texts[] = {"",     "d",         "30",         "30x",         "30dd",       "-30d",
                                        "1.5h", "yesterday", "2026-13-01", "2026-03-01T", "9999999999d"};

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct error error = {0};
        int64_t unix_s;

        assert_false(moment_parse(texts[i], NOW, &unix_s, &error));
        assert_true(*error.message);
    }
}

static void a_span_is_more_than_nothing(void **state)
{
    static const char *const wrong[] = {"", "0d", "30", "never", "2026-03-01", "-1d"};
    int64_t seconds;

    assert_true(moment_parse_span("12h", &seconds, NULL));
    assert_int_equal(seconds, 43200);
    assert_true(moment_parse_span("1s", &seconds, NULL));
    assert_int_equal(seconds, 1);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct error error = {0};

        assert_false(moment_parse_span(wrong[i], &seconds, &error));
        assert_non_null(strstr(error.message, "expected a time such as 12h or 30d"));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ages_are_before_now),
        cmocka_unit_test(an_age_beyond_all_time_is_the_beginning),
        cmocka_unit_test(dates_are_local),
        cmocka_unit_test(anything_else_is_refused),
        cmocka_unit_test(a_span_is_more_than_nothing),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
