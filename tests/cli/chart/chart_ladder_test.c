// SPDX-License-Identifier: Apache-2.0
#include "cli/chart/chart_ladder.h"

#include "cli/chart/chart_points.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_read.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const struct chart_limits LIMITS = {.seconds = 10, .error = 3e-5};

static size_t find_series(const char *name)
{
    for (size_t i = 0; i < chart_ladder_count(); i++)
        if (strcmp(chart_ladder_name(i), name) == 0) return i;
    fail_msg("no series %s", name);
    return 0;
}

static void add(struct chart_points *points, const char *series, int rung, enum chart_outcome outcome, double error)
{
    struct chart_point point = {.rung = rung, .quality = xstrdup("{}"), .outcome = outcome, .error = error};

    snprintf(point.series, sizeof point.series, "%s", series);
    chart_points_add(points, &point);
}

// A number in the quality of a rung.
static double number_of(const char *series, int rung, const struct chart_scale *scale, const char *key)
{
    char *text = chart_ladder_quality(find_series(series), rung, scale, &(struct json_node){0});
    struct json_node node, member;
    struct cJSON *root = NULL;
    double number = NAN;

    assert_true(json_parse(&root, text, strlen(text), NULL));
    node = json_node_root(root);
    member = json_node_child(&node, key);
    json_read_number(&member, -1e12, 1e12, &number, NULL);
    json_delete(root);
    free(text);
    return number;
}

static const struct chart_scale ball = {.near = 1, .far = 3, .length = 2};

static void riemann_refines_both_its_sums(void **state)
{
    for (int rung = 1; rung < 8; rung++) {
        assert_float_equal(number_of("riemann", rung, &ball, "step"), number_of("riemann", rung - 1, &ball, "step") / 2,
                           1e-12);
        assert_float_equal(number_of("riemann", rung, &ball, "light_steps"),
                           number_of("riemann", rung - 1, &ball, "light_steps") * 2, 1e-12);
    }
    assert_float_equal(number_of("riemann", 0, &ball, "step"), 0.25, 1e-12);
}

static void riemann_never_steps_over_all(void **state)
{
    const struct chart_scale flat = {.near = 1, .far = 1.01, .length = 2};

    assert_true(number_of("riemann", 0, &flat, "step") <= flat.far - flat.near);
}

// Noise falls with the root of the number of paths.
static void random_paths_halve_their_error(void **state)
{
    for (int rung = 1; rung < 9; rung++) {
        assert_float_equal(number_of("paths", rung, &ball, "paths"), number_of("paths", rung - 1, &ball, "paths") * 4,
                           1e-12);
        assert_true(number_of("scatter grid", rung, &ball, "scatter_grid") >
                    number_of("scatter grid", rung - 1, &ball, "scatter_grid"));
        assert_true(number_of("scatter grid", rung, &ball, "paths") >
                    2 * number_of("scatter grid", rung - 1, &ball, "paths"));
    }
    assert_float_equal(number_of("paths", CHART_RUNG_LIMIT - 1, &ball, "paths"), 1048576.0, 1e-12);
    assert_float_equal(number_of("scatter grid", 2, &ball, "scatter_grid"), 16, 1e-12);
    assert_float_equal(number_of("scatter grid", 2, &ball, "step"), number_of("cached", 2, &ball, "step"), 1e-12);
}

static void grids_are_measured_in_voxels(void **state)
{
    const struct chart_scale head = {.near = 1, .far = 3, .length = 2, .voxel = 0.001};

    assert_float_equal(number_of("midpoint", 3, &head, "step"), 0.001, 1e-12);
}

static void samples_and_paths_are_the_jobs(void **state)
{
    static const char JOB[] = "{\"method\":\"midpoint\",\"step\":9,\"samples\":4,\"max_depth\":3,\"roulette\":{}}";
    struct cJSON *root = NULL;
    struct json_node quality;
    char *text;

    assert_true(json_parse(&root, JOB, strlen(JOB), NULL));
    quality = json_node_root(root);
    text = chart_ladder_quality(find_series("equiangular"), 2, &ball, &quality);
    assert_string_equal(text, "{\"method\":\"equiangular\",\"points\":4,\"samples\":4,\"max_depth\":3}");
    free(text);
    text = chart_ladder_quality(find_series("tracking"), 2, &ball, &quality);
    assert_non_null(strstr(text, "\"samples\":4}"));
    free(text);
    text = chart_ladder_quality(find_series("tracking"), 4, &ball, &quality);
    assert_non_null(strstr(text, "\"samples\":16}"));
    free(text);
    json_delete(root);
}

static void riemann_is_told_of_no_paths(void **state)
{
    static const char JOB[] = "{\"samples\":4,\"max_depth\":3,\"max_cut\":0.5}";
    struct cJSON *root = NULL;
    struct json_node quality;
    char *text;

    assert_true(json_parse(&root, JOB, strlen(JOB), NULL));
    quality = json_node_root(root);
    text = chart_ladder_quality(find_series("riemann"), 2, &ball, &quality);
    assert_non_null(strstr(text, "\"samples\":4}"));
    free(text);
    text = chart_ladder_tolerance(0.02, &quality);
    assert_string_equal(text, "{\"tolerance\":0.02,\"samples\":4,\"max_depth\":3,\"max_cut\":0.5}");
    free(text);
    json_delete(root);
}

static void every_rung_is_json_of_its_method(void **state)
{
    for (size_t series = 0; series < chart_ladder_count(); series++)
        for (int rung = 0; rung < CHART_RUNG_LIMIT; rung++) {
            char *text = chart_ladder_quality(series, rung, &ball, &(struct json_node){0});
            struct json_node node, member;
            struct cJSON *root = NULL;
            const char *method;

            assert_true(json_parse(&root, text, strlen(text), NULL));
            node = json_node_root(root);
            member = json_node_child(&node, "method");
            assert_true(json_read_string(&member, &method, NULL));
            assert_string_equal(method, chart_ladder_method(series));
            json_delete(root);
            free(text);
        }
}

static void climb_goes_on_while_it_pays(void **state)
{
    size_t series = find_series("midpoint");
    struct chart_points points = {0};

    assert_int_equal(chart_ladder_next(&points, series, &LIMITS), 0);
    for (int rung = 0; rung < 6; rung++) {
        add(&points, "midpoint", rung, CHART_MEASURED, exp2(-2.0 * rung));
        add(&points, "riemann", rung, CHART_MEASURED, 1e-9);
        assert_int_equal(chart_ladder_next(&points, series, &LIMITS), rung + 1);
    }
    chart_points_finish(&points);
}

static void climb_ends_where_truth_does(void **state)
{
    struct chart_points points = {0};

    add(&points, "midpoint", 0, CHART_MEASURED, 0.1);
    add(&points, "midpoint", 1, CHART_MEASURED, 1e-5);
    assert_int_equal(chart_ladder_next(&points, find_series("midpoint"), &LIMITS), -1);
    chart_points_finish(&points);
}

static void climb_ends_where_nothing_is_gained(void **state)
{
    static const double errors[] = {0.5, 0.1, 0.099, 0.098, 0.099};
    struct chart_points points = {0};
    size_t series = find_series("midpoint");

    for (int rung = 0; rung < 5; rung++) {
        assert_int_equal(chart_ladder_next(&points, series, &LIMITS), rung);
        add(&points, "midpoint", rung, CHART_MEASURED, errors[rung]);
    }
    assert_int_equal(chart_ladder_next(&points, series, &LIMITS), -1);
    chart_points_finish(&points);
}

static void climb_ends_when_it_takes_too_long(void **state)
{
    struct chart_points points = {0};

    add(&points, "midpoint", 0, CHART_MEASURED, 0.1);
    add(&points, "midpoint", 1, CHART_TOO_SLOW, 0);
    assert_int_equal(chart_ladder_next(&points, find_series("midpoint"), &LIMITS), -1);
    chart_points_finish(&points);
}

static void climb_ends_before_it_takes_too_long(void **state)
{
    struct chart_points points = {0};
    size_t series = find_series("midpoint");

    add(&points, "midpoint", 0, CHART_MEASURED, 0.1);
    add(&points, "midpoint", 1, CHART_MEASURED, 0.01);
    points.list[0].seconds = 1;
    points.list[1].seconds = 3.5; // 12.3 s to come, which may yet be less
    assert_int_equal(chart_ladder_next(&points, series, &LIMITS), 2);
    points.list[1].seconds = 4; // 16 s
    assert_int_equal(chart_ladder_next(&points, series, &LIMITS), -1);
    chart_points_finish(&points);
}

static void coarse_rungs_may_be_refused(void **state)
{
    struct chart_points points = {0};
    size_t series = find_series("midpoint");

    add(&points, "midpoint", 0, CHART_REFUSED, 0);
    add(&points, "midpoint", 1, CHART_REFUSED, 0);
    assert_int_equal(chart_ladder_next(&points, series, &LIMITS), 2);
    add(&points, "midpoint", 2, CHART_MEASURED, 0.1);
    assert_int_equal(chart_ladder_next(&points, series, &LIMITS), 3);
    add(&points, "midpoint", 3, CHART_REFUSED, 0);
    assert_int_equal(chart_ladder_next(&points, series, &LIMITS), -1);
    chart_points_finish(&points);
}

static void a_method_that_is_always_refused_is_given_up(void **state)
{
    struct chart_points points = {0};

    for (int rung = 0; rung < 3; rung++)
        add(&points, "midpoint", rung, CHART_REFUSED, 0);
    assert_int_equal(chart_ladder_next(&points, find_series("midpoint"), &LIMITS), -1);
    chart_points_finish(&points);
}

static void choice_names_methods_series_and_rungs(void **state)
{
    struct chart_points points = {0};
    struct chart_choice choice;

    assert_true(chart_choice_parse(&choice, "gauss,riemann:7,cached baked", NULL));
    assert_int_equal(chart_choice_next(&choice, &points, find_series("gauss 2"), &LIMITS), 0);
    assert_int_equal(chart_choice_next(&choice, &points, find_series("gauss 4"), &LIMITS), 0);
    assert_int_equal(chart_choice_next(&choice, &points, find_series("cached baked"), &LIMITS), 0);
    assert_int_equal(chart_choice_next(&choice, &points, find_series("cached"), &LIMITS), -1);
    assert_int_equal(chart_choice_next(&choice, &points, find_series("midpoint"), &LIMITS), -1);
    assert_int_equal(chart_choice_next(&choice, &points, find_series("riemann"), &LIMITS), 7);
    add(&points, "riemann", 7, CHART_MEASURED, 0.5);
    assert_int_equal(chart_choice_next(&choice, &points, find_series("riemann"), &LIMITS), -1);
    chart_choice_finish(&choice);
    chart_points_finish(&points);
}

static void planner_is_chosen_by_name(void **state)
{
    struct chart_choice choice;

    assert_true(chart_choice_parse(&choice, "riemann,auto", NULL));
    assert_true(chart_choice_has_planned(&choice));
    chart_choice_finish(&choice);
    assert_true(chart_choice_parse(&choice, "riemann", NULL));
    assert_false(chart_choice_has_planned(&choice));
    chart_choice_finish(&choice);
}

static void no_choice_is_all(void **state)
{
    struct chart_choice choice = {0};
    struct chart_points points = {0};

    assert_true(chart_choice_has_planned(&choice));
    for (size_t series = 0; series < chart_ladder_count(); series++)
        assert_int_equal(chart_choice_next(&choice, &points, series, &LIMITS), 0);
}

static void a_short_chart_leaves_samples_out_that_nobody_named(void **state)
{
    const struct chart_limits limits = {.seconds = 10, .error = 3e-5, .is_short = true};
    struct chart_points points = {0};
    struct chart_choice choice = {0};

    assert_int_equal(chart_choice_next(&choice, &points, find_series("tracking"), &limits), -1);
    assert_int_equal(chart_choice_next(&choice, &points, find_series("jittered"), &limits), 0);
    assert_true(chart_choice_parse(&choice, "tracking", NULL));
    assert_int_equal(chart_choice_next(&choice, &points, find_series("tracking"), &limits), 0);
    chart_choice_finish(&choice);
}

static void wrong_choices_are_refused(void **state)
{
    static const char *const wrong[] = {"", "riemann,", "magic", "riemann:", "riemann:x", "riemann:-1", "riemann:20"};

    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct error error = {{0}};
        struct chart_choice choice;

        assert_false(chart_choice_parse(&choice, wrong[i], &error));
        assert_non_null(strstr(error.message, "--methods"));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(riemann_refines_both_its_sums),
        cmocka_unit_test(riemann_never_steps_over_all),
        cmocka_unit_test(random_paths_halve_their_error),
        cmocka_unit_test(grids_are_measured_in_voxels),
        cmocka_unit_test(samples_and_paths_are_the_jobs),
        cmocka_unit_test(riemann_is_told_of_no_paths),
        cmocka_unit_test(every_rung_is_json_of_its_method),
        cmocka_unit_test(climb_goes_on_while_it_pays),
        cmocka_unit_test(climb_ends_where_truth_does),
        cmocka_unit_test(climb_ends_where_nothing_is_gained),
        cmocka_unit_test(climb_ends_when_it_takes_too_long),
        cmocka_unit_test(climb_ends_before_it_takes_too_long),
        cmocka_unit_test(coarse_rungs_may_be_refused),
        cmocka_unit_test(a_method_that_is_always_refused_is_given_up),
        cmocka_unit_test(choice_names_methods_series_and_rungs),
        cmocka_unit_test(planner_is_chosen_by_name),
        cmocka_unit_test(no_choice_is_all),
        cmocka_unit_test(a_short_chart_leaves_samples_out_that_nobody_named),
        cmocka_unit_test(wrong_choices_are_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
