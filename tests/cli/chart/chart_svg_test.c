// SPDX-License-Identifier: Apache-2.0
#include "cli/chart/chart_svg.h"

#include "cli/chart/chart_axis.h"
#include "cli/chart/chart_ladder.h"
#include "cli/chart/chart_points.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "tests/support/temp_folder.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static void axis_holds_whole_decades(void **state)
{
    struct chart_axis axis = {0};

    chart_axis_add(&axis, 0.03);
    assert_int_equal(axis.first, -2);
    assert_int_equal(axis.last, -1);
    chart_axis_add(&axis, 0.001);
    assert_int_equal(axis.first, -3);
    chart_axis_add(&axis, 1.0);
    assert_int_equal(axis.last, 0);
    chart_axis_add(&axis, 1.01);
    assert_int_equal(axis.last, 1);
    chart_axis_add(&axis, 0);
    chart_axis_add(&axis, -1);
    chart_axis_add(&axis, INFINITY);
    chart_axis_add(&axis, NAN);
    assert_int_equal(axis.first, -3);
    assert_int_equal(axis.last, 1);
    assert_float_equal(chart_axis_position(&axis, 0.1), 0.5, 1e-12);
}

static void one_value_is_an_axis_too(void **state)
{
    struct chart_axis axis = {0};

    chart_axis_add(&axis, 0.01);
    assert_float_equal(chart_axis_position(&axis, 0.01), 0.0, 1e-12);
}

static void labels_have_units(void **state)
{
    char label[CHART_LABEL_SIZE];

    chart_axis_format_seconds(1e-5, label);
    assert_string_equal(label, "10 µs");
    chart_axis_format_seconds(1e-3, label);
    assert_string_equal(label, "1 ms");
    chart_axis_format_seconds(0.1, label);
    assert_string_equal(label, "100 ms");
    chart_axis_format_seconds(1, label);
    assert_string_equal(label, "1 s");
    chart_axis_format_seconds(10000, label);
    assert_string_equal(label, "10000 s");
    chart_axis_format_percent(0.0001, label);
    assert_string_equal(label, "0.01 %");
    chart_axis_format_percent(10, label);
    assert_string_equal(label, "1000 %");
}

static void fill(struct chart_points *points)
{
    *points = (struct chart_points){
        .facts = {.name = "a < b & \"c\"", .frame = 3, .width_px = 320, .height_px = 180, .backend = "osmesa"}};
    for (size_t series = 0; series < chart_ladder_count(); series++)
        for (int rung = 0; rung < 5; rung++) {
            struct chart_point point = {.rung = rung,
                                        .quality = xstrdup("{}"),
                                        .outcome = rung == 4 ? CHART_TOO_SLOW : CHART_MEASURED,
                                        .seconds = 1e-3 * exp2(rung + 0.3 * (double)series),
                                        .error = rung == 3 && series == 0 ? INFINITY : 0.3 * exp2(-2 * rung),
                                        .truth = "reference",
                                        .timer = "wall",
                                        .pixels = 100};

            snprintf(point.series, sizeof point.series, "%s", chart_ladder_name(series));
            chart_points_add(points, &point);
        }
}

static size_t count(const char *text, const char *part)
{
    size_t found = 0;

    for (; (text = strstr(text, part)); text += strlen(part))
        found++;
    return found;
}

static void picture_shows_what_was_measured(void **state)
{
    const struct chart_svg_mark mark = {.tolerance = 0.01, .seconds = 0.004, .error = 0.008, .label = "gauss & co"};
    struct chart_points points;
    char *text;

    fill(&points);
    text = chart_svg_format(&points, &mark);
    // Four points in each series, less the one that is not finite, and a marker in the legend.
    assert_int_equal(count(text, "class=\"mark "), 5 * chart_ladder_count() - 1);
    assert_int_equal(count(text, "class=\"line "), 2 * chart_ladder_count());
    assert_int_equal(count(text, "class=\"star\""), 2);
    assert_int_equal(count(text, "class=\"tolerance\""), 1);
    assert_int_equal(count(text, "class=\"front\""), 2);
    assert_non_null(strstr(text, "a &lt; b &amp;"));
    assert_non_null(strstr(text, "prefers-color-scheme:dark"));
    assert_null(strstr(text, "nan"));
    assert_null(strstr(text, "inf\""));
    for (size_t series = 0; series < chart_ladder_count(); series++)
        assert_non_null(strstr(text, chart_ladder_name(series)));
    free(text);
    chart_points_finish(&points);
}

static void nothing_measured_is_said(void **state)
{
    struct chart_points points = {0};
    char *text = chart_svg_format(&points, NULL);

    assert_non_null(strstr(text, "nothing was measured"));
    assert_null(strstr(text, "nan"));
    free(text);
}

static void check_well_formed(void **state, const struct chart_points *points)
{
    const char *path = temp_folder_path(state, "chart.svg");
    char *command = xasprintf("xmllint --noout '%s'", path);
    struct error error = {{0}};

    assert_true(chart_svg_save(points, &(struct chart_svg_mark){.tolerance = 0.01}, path, &error));
    assert_int_equal(system(command), 0);
    free(command);
}

static void picture_is_well_formed(void **state)
{
    struct chart_points points;

    if (access("/usr/bin/xmllint", X_OK) != 0) {
        print_message("skipped: no xmllint\n");
        skip();
    }
    fill(&points);
    snprintf(points.facts.renderer, sizeof points.facts.renderer, "GL\x01 <&>");
    check_well_formed(state, &points);
    chart_points_finish(&points);
    check_well_formed(state, &points);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(axis_holds_whole_decades),
        cmocka_unit_test(one_value_is_an_axis_too),
        cmocka_unit_test(labels_have_units),
        cmocka_unit_test(picture_shows_what_was_measured),
        cmocka_unit_test(nothing_measured_is_said),
        cmocka_unit_test_setup_teardown(picture_is_well_formed, temp_folder_create, temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
