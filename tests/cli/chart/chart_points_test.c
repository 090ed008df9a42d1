// SPDX-License-Identifier: Apache-2.0
#include "cli/chart/chart_points.h"

#include "core/base/alloc.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

static void add(struct chart_points *points, const char *series, int rung, double seconds, double error)
{
    struct chart_point point = {
        .rung = rung, .quality = xstrdup("{}"), .outcome = CHART_MEASURED, .seconds = seconds, .error = error};

    snprintf(point.series, sizeof point.series, "%s", series);
    chart_points_add(points, &point);
}

static void time_follows_a_line_of_logarithms(void **state)
{
    struct chart_points points = {0};

    // Four times the seconds, a sixteenth of the error: error 1 / 100 of the first takes ten times as long.
    add(&points, "midpoint", 0, 1.0, 0.1);
    add(&points, "midpoint", 1, 4.0, 0.1 / 16);
    add(&points, "midpoint", 2, 16.0, 0.1 / 256);
    assert_float_equal(chart_points_time(&points, "midpoint", 0.001), 10.0, 1e-9);
    assert_float_equal(chart_points_time(&points, "midpoint", 0.1), 1.0, 1e-12);
    assert_float_equal(chart_points_time(&points, "midpoint", 0.5), 1.0, 1e-12);
    assert_true(isnan(chart_points_time(&points, "midpoint", 1e-4)));
    assert_true(isnan(chart_points_time(&points, "riemann", 0.1)));
    chart_points_finish(&points);
}

static void detours_of_a_series_do_not_count(void **state)
{
    struct chart_points points = {0};

    add(&points, "midpoint", 0, 1.0, 0.1);
    add(&points, "midpoint", 1, 2.0, 0.4);
    add(&points, "midpoint", 2, 10.0, 0.001);
    assert_float_equal(chart_points_time(&points, "midpoint", 0.01), pow(10.0, 0.5), 1e-9);
    chart_points_finish(&points);
}

static void failed_points_give_no_time(void **state)
{
    struct chart_points points = {0};

    add(&points, "midpoint", 0, 1.0, 0.0);
    points.list[0].outcome = CHART_REFUSED;
    assert_true(isnan(chart_points_time(&points, "midpoint", 0.1)));
    chart_points_finish(&points);
}

static void front_has_what_nothing_beats(void **state)
{
    struct chart_points points = {0};

    add(&points, "midpoint", 0, 1.0, 0.1);
    add(&points, "midpoint", 1, 2.0, 0.01);
    add(&points, "riemann", 0, 2.0, 0.1);   // slower and no better
    add(&points, "riemann", 1, 3.0, 0.02);  // slower and worse
    add(&points, "riemann", 2, 0.5, 0.9);   // the fastest
    add(&points, "riemann", 3, 0.1, 0.001); // not measured
    points.list[5].outcome = CHART_TOO_SLOW;
    assert_true(chart_points_is_best(&points, 0));
    assert_true(chart_points_is_best(&points, 1));
    assert_false(chart_points_is_best(&points, 2));
    assert_false(chart_points_is_best(&points, 3));
    assert_true(chart_points_is_best(&points, 4));
    assert_false(chart_points_is_best(&points, 5));
    chart_points_finish(&points);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(time_follows_a_line_of_logarithms),
        cmocka_unit_test(detours_of_a_series_do_not_count),
        cmocka_unit_test(failed_points_give_no_time),
        cmocka_unit_test(front_has_what_nothing_beats),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
