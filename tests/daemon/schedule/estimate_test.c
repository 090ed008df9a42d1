// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/estimate.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// Durations are kept in single precision.
#define FLOAT_TOLERANCE 1e-6

static void nothing_is_known_at_first(void **state)
{
    struct estimate estimate = {0};

    assert_int_equal(estimate_count(&estimate), 0);
    assert_true(estimate_median_s(&estimate) == 0);
    assert_true(estimate_eta_s(&estimate, 10, 10, 2) < 0);
}

static void median_ignores_one_slow_frame(void **state)
{
    struct estimate estimate = {0};

    estimate_add(&estimate, 2);
    estimate_add(&estimate, 1000);
    estimate_add(&estimate, 1);
    assert_float_equal(estimate_median_s(&estimate), 2, FLOAT_TOLERANCE);
    estimate_add(&estimate, 4);
    assert_float_equal(estimate_median_s(&estimate), 3, FLOAT_TOLERANCE);
}

static void median_follows_the_recent_frames(void **state)
{
    struct estimate estimate = {0};

    for (int i = 0; i < 1000; i++)
        estimate_add(&estimate, 1);
    assert_int_equal(estimate_count(&estimate), ESTIMATE_RECENT);
    for (int i = 0; i < ESTIMATE_RECENT / 2; i++)
        estimate_add(&estimate, 5);
    assert_float_equal(estimate_median_s(&estimate), 1, FLOAT_TOLERANCE);
    estimate_add(&estimate, 5);
    assert_float_equal(estimate_median_s(&estimate), 5, FLOAT_TOLERANCE);
}

static void immeasurable_frame_is_known_to_be_short(void **state)
{
    struct estimate estimate = {0};

    estimate_add(&estimate, 0);
    assert_true(estimate_median_s(&estimate) > 0);
    assert_true(estimate_median_s(&estimate) <= 1e-6);
}

static void skipped_frames_teach_nothing_about_rendering(void **state)
{
    struct estimate estimate = {0};

    estimate_add_skip(&estimate, 1e-3);
    estimate_add_skip(&estimate, 3e-3);
    assert_true(estimate_median_s(&estimate) == 0);
    assert_true(estimate_eta_s(&estimate, 10, 10, 2) < 0);
    assert_int_equal(estimate.skip_run, 2);
    assert_float_equal(estimate.skip_s, 2e-3, FLOAT_TOLERANCE);
    estimate_add(&estimate, 5);
    assert_int_equal(estimate.skip_run, 0);
    assert_float_equal(estimate_median_s(&estimate), 5, FLOAT_TOLERANCE);
}

static void impossible_durations_are_ignored(void **state)
{
    struct estimate estimate = {0};

    estimate_add(&estimate, (double)NAN);
    estimate_add(&estimate, (double)INFINITY);
    estimate_add(&estimate, -1);
    assert_int_equal(estimate_count(&estimate), 0);
}

static void eta_counts_rounds_of_all_workers(void **state)
{
    struct estimate estimate = {0};

    estimate_add(&estimate, 2);
    assert_float_equal(estimate_eta_s(&estimate, 10, 10, 2), 10, FLOAT_TOLERANCE);
    assert_float_equal(estimate_eta_s(&estimate, 10, 9, 2), 10, FLOAT_TOLERANCE);
    assert_float_equal(estimate_eta_s(&estimate, 10, 1, 8), 2, FLOAT_TOLERANCE);
    assert_float_equal(estimate_eta_s(&estimate, 10, 0, 8), 0, FLOAT_TOLERANCE);
}

// Audits, files and linking take a worker's time, which a median of rendering does not show.
static void eta_counts_all_that_a_worker_does(void **state)
{
    struct estimate estimate = {0};

    for (int i = 0; i < 24; i++) {
        estimate_add(&estimate, 1);
        estimate_add_pace(&estimate, 3, 1);
    }
    assert_float_equal(estimate_median_s(&estimate), 1, FLOAT_TOLERANCE);
    assert_float_equal(estimate_eta_s(&estimate, 10, 10, 2), 15, FLOAT_TOLERANCE);
}

static void eta_forgets_a_slow_frame(void **state)
{
    struct estimate estimate = {0};
    double eta_s;

    for (int i = 0; i < 24; i++) {
        estimate_add(&estimate, 1);
        estimate_add_pace(&estimate, i == 0 ? 10 : 1, 1);
    }
    eta_s = estimate_eta_s(&estimate, 124, 100, 1);
    assert_true(eta_s > 99.9 && eta_s < 140.0);
}

// Programs are linked once, so the first frame of a worker counts as what it says of the frame.
static void eta_leaves_out_how_workers_begin(void **state)
{
    struct estimate estimate = {0};

    estimate_add(&estimate, 2);
    estimate_add_first(&estimate, 9, 2, 1);
    assert_float_equal(estimate_eta_s(&estimate, 10, 9, 1), 18, FLOAT_TOLERANCE);
    // Its parts may overlap.
    estimate_add_first(&estimate, 1, 2, 1);
    assert_float_equal(estimate_eta_s(&estimate, 10, 8, 1), 12, FLOAT_TOLERANCE);
}

// The first frames of a segment may take more work than its others.
static void eta_goes_by_the_work_of_frames(void **state)
{
    struct estimate estimate = {0};

    estimate_add(&estimate, 6);
    estimate_add_pace(&estimate, 6, 3);
    estimate_add_pace(&estimate, 4, 2);
    assert_float_equal(estimate_eta_s(&estimate, 10, 8, 1), 2 * (10 - 5), FLOAT_TOLERANCE);
    estimate_add_pace(&estimate, 1, 0.5);
    assert_float_equal(estimate_eta_s(&estimate, 10, 7, 1), 2 * (10 - 5.5), FLOAT_TOLERANCE);
    // A prediction that was too large does not make the rest nothing.
    estimate_add_pace(&estimate, 16, 8);
    assert_true(estimate_eta_s(&estimate, 10, 6, 1) > 1);
}

// The segment that frames are rendered of has its plan; those behind it need one each, the last one however short.
static void eta_counts_the_plans_that_are_left(void **state)
{
    struct estimate estimate = {0};

    estimate_add(&estimate, 1);
    estimate_add_pace(&estimate, 1, 1);
    assert_float_equal(estimate_eta_s(&estimate, 110, 100, 2), 50, FLOAT_TOLERANCE);
    estimate_add_plan(&estimate, 10, 48);
    estimate_add_plan(&estimate, 14, 48);
    assert_float_equal(estimate_eta_s(&estimate, 110, 100, 2), 50 + 2 * 12, FLOAT_TOLERANCE);
    assert_float_equal(estimate_eta_s(&estimate, 50, 10, 2), 5 + 12, FLOAT_TOLERANCE);
    assert_float_equal(estimate_eta_s(&estimate, 48, 10, 2), 5, FLOAT_TOLERANCE);
    estimate_add_plan(&estimate, 12, 2); // of the last segment
    assert_float_equal(estimate_eta_s(&estimate, 50, 5, 1), 5 + 12, FLOAT_TOLERANCE);
    estimate_add_plan(&estimate, 99, 0);
    assert_float_equal(estimate_eta_s(&estimate, 50, 5, 1), 5 + 12, FLOAT_TOLERANCE);
}

static void a_plan_foretells_until_a_frame_is_done(void **state)
{
    struct estimate estimate = {0};

    estimate_foretell(&estimate, 0);
    assert_true(estimate_eta_s(&estimate, 10, 10, 2) < 0);
    estimate_foretell(&estimate, 90);
    assert_float_equal(estimate_eta_s(&estimate, 10, 10, 2), 450, FLOAT_TOLERANCE);
    assert_float_equal(estimate_each_s(&estimate), 90, FLOAT_TOLERANCE);
    assert_true(estimate_median_s(&estimate) == 0);
    estimate_add(&estimate, 60);
    assert_float_equal(estimate_each_s(&estimate), 60, FLOAT_TOLERANCE);
    assert_float_equal(estimate_eta_s(&estimate, 10, 9, 2), 300, FLOAT_TOLERANCE);
}

static void eta_is_unknown_without_workers(void **state)
{
    struct estimate estimate = {0};

    estimate_add(&estimate, 2);
    assert_true(estimate_eta_s(&estimate, 10, 10, 0) < 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_known_at_first),
        cmocka_unit_test(median_ignores_one_slow_frame),
        cmocka_unit_test(median_follows_the_recent_frames),
        cmocka_unit_test(immeasurable_frame_is_known_to_be_short),
        cmocka_unit_test(skipped_frames_teach_nothing_about_rendering),
        cmocka_unit_test(impossible_durations_are_ignored),
        cmocka_unit_test(eta_counts_rounds_of_all_workers),
        cmocka_unit_test(eta_counts_all_that_a_worker_does),
        cmocka_unit_test(eta_forgets_a_slow_frame),
        cmocka_unit_test(eta_leaves_out_how_workers_begin),
        cmocka_unit_test(eta_goes_by_the_work_of_frames),
        cmocka_unit_test(eta_counts_the_plans_that_are_left),
        cmocka_unit_test(a_plan_foretells_until_a_frame_is_done),
        cmocka_unit_test(eta_is_unknown_without_workers),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
