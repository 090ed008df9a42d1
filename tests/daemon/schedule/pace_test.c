// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/pace.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#define S UINT64_C(1000000000)
#define TOLERANCE 1e-9

static void frames_take_the_time_between_answers(void **state)
{
    struct pace pace = {0};
    bool is_first;

    pace_begin(&pace, 10 * S);
    assert_float_equal(pace_answer(&pace, 1, 12 * S, &is_first), 2, TOLERANCE);
    assert_true(is_first);
    assert_float_equal(pace_answer(&pace, 1, 15 * S, &is_first), 3, TOLERANCE);
    assert_false(is_first);
    assert_float_equal(pace_answer(&pace, 2, 16 * S, &is_first), 1, TOLERANCE);
    assert_true(is_first);
    pace_begin(&pace, 20 * S);
    assert_float_equal(pace_answer(&pace, 2, 21 * S, &is_first), 1, TOLERANCE);
    assert_false(is_first);
    assert_float_equal(pace_answer(&pace, 2, 21 * S, NULL), 1e-6, TOLERANCE);
}

static void plans_are_no_part_of_a_frame(void **state)
{
    struct pace pace = {0};
    bool is_first;

    pace_begin(&pace, 10 * S);
    assert_true(pace_end_plan(&pace, 11 * S) < 0);
    pace_answer(&pace, 1, 11 * S, NULL);
    pace_begin_plan(&pace, 12 * S);
    assert_float_equal(pace_end_plan(&pace, 17 * S), 5, TOLERANCE);
    assert_float_equal(pace_answer(&pace, 1, 19 * S, &is_first), 3, TOLERANCE);
    assert_true(is_first);
    pace_answer(&pace, 1, 20 * S, &is_first);
    assert_false(is_first);
}

// The frame before is encoded while the worker plans for the next one.
static void a_plan_may_begin_before_an_answer(void **state)
{
    struct pace pace = {0};
    bool is_first;

    pace_begin(&pace, 10 * S);
    pace_answer(&pace, 1, 11 * S, NULL);
    pace_begin_plan(&pace, 13 * S);
    assert_float_equal(pace_answer(&pace, 1, 14 * S, &is_first), 2, TOLERANCE);
    assert_false(is_first);
    assert_float_equal(pace_end_plan(&pace, 18 * S), 5, TOLERANCE);
    assert_float_equal(pace_answer(&pace, 1, 20 * S, &is_first), 2, TOLERANCE);
    assert_true(is_first);
}

static void a_plan_that_fails_is_forgotten(void **state)
{
    struct pace pace = {0};

    pace_begin(&pace, 10 * S);
    pace_begin_plan(&pace, 11 * S);
    assert_float_equal(pace_answer(&pace, 1, 13 * S, NULL), 1, TOLERANCE);
    pace_drop_plan(&pace);
    assert_float_equal(pace_answer(&pace, 1, 15 * S, NULL), 2, TOLERANCE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_take_the_time_between_answers),
        cmocka_unit_test(plans_are_no_part_of_a_frame),
        cmocka_unit_test(a_plan_may_begin_before_an_answer),
        cmocka_unit_test(a_plan_that_fails_is_forgotten),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
