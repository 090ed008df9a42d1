// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/hand.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void give(struct hand *hand, int64_t job, int32_t first, int32_t count)
{
    for (int32_t i = 0; i < count; i++)
        hand_add(hand, &(struct queue_ticket){.job = job, .frame = first + i, .index = i, .attempt = 1});
}

static void a_frame_is_found_by_job_number_and_attempt(void **state)
{
    struct hand hand = {0};

    give(&hand, 3, 10, 5);
    assert_int_equal(hand_find(&hand, 3, 12, 1)->ticket.frame, 12);
    assert_null(hand_find(&hand, 4, 12, 1));
    assert_null(hand_find(&hand, 3, 12, 2));
    assert_null(hand_find(&hand, 3, 15, 1));
    hand_finish(&hand);
}

static void removing_keeps_the_order_of_the_others(void **state)
{
    struct hand hand = {0};

    give(&hand, 3, 0, 4);
    hand_remove(&hand, hand_find(&hand, 3, 1, 1));
    hand_remove(&hand, hand_find(&hand, 3, 3, 1));
    assert_int_equal(hand.count, 2);
    assert_int_equal(hand.frames[0].ticket.frame, 0);
    assert_int_equal(hand.frames[1].ticket.frame, 2);
    hand_finish(&hand);
}

static void rendered_frames_are_counted_once_until_they_leave(void **state)
{
    struct hand hand = {0};

    give(&hand, 3, 0, 2);
    hand_render(&hand, &hand.frames[0]);
    hand_render(&hand, &hand.frames[0]);
    assert_int_equal(hand.rendered_count, 1);
    hand_remove(&hand, &hand.frames[0]);
    assert_int_equal(hand.rendered_count, 0);
    hand_finish(&hand);
}

static void the_current_job_is_that_of_the_frame_being_rendered(void **state)
{
    struct hand hand = {0};

    assert_int_equal(hand_current_job(&hand), 0);
    assert_null(hand_current(&hand));
    give(&hand, 3, 0, 1);
    give(&hand, 5, 0, 1);
    assert_int_equal(hand_current_job(&hand), 3);
    hand_render(&hand, &hand.frames[0]);
    assert_int_equal(hand_current_job(&hand), 5);
    hand_render(&hand, &hand.frames[1]);
    assert_int_equal(hand_current_job(&hand), 3);
    assert_true(hand_holds_job(&hand, 5));
    assert_false(hand_holds_job(&hand, 4));
    hand_finish(&hand);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_frame_is_found_by_job_number_and_attempt),
        cmocka_unit_test(removing_keeps_the_order_of_the_others),
        cmocka_unit_test(rendered_frames_are_counted_once_until_they_leave),
        cmocka_unit_test(the_current_job_is_that_of_the_frame_being_rendered),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
