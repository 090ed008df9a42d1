// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/in_flight.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void assign(struct in_flight *in_flight, int64_t job, int32_t first, int32_t count)
{
    for (int32_t i = 0; i < count; i++)
        in_flight_add(in_flight, &(struct queue_ticket){.job = job, .frame = first + i, .index = i, .attempt = 1});
}

static void a_frame_is_found_by_job_number_and_attempt(void **state)
{
    struct in_flight in_flight = {0};

    assign(&in_flight, 3, 10, 5);
    assert_int_equal(in_flight_find(&in_flight, 3, 12, 1)->ticket.frame, 12);
    assert_null(in_flight_find(&in_flight, 4, 12, 1));
    assert_null(in_flight_find(&in_flight, 3, 12, 2));
    assert_null(in_flight_find(&in_flight, 3, 15, 1));
    in_flight_finish(&in_flight);
}

static void removing_keeps_the_order_of_the_others(void **state)
{
    struct in_flight in_flight = {0};

    assign(&in_flight, 3, 0, 4);
    in_flight_remove(&in_flight, in_flight_find(&in_flight, 3, 1, 1));
    in_flight_remove(&in_flight, in_flight_find(&in_flight, 3, 3, 1));
    assert_int_equal(in_flight.count, 2);
    assert_int_equal(in_flight.frames[0].ticket.frame, 0);
    assert_int_equal(in_flight.frames[1].ticket.frame, 2);
    in_flight_finish(&in_flight);
}

static void rendered_frames_are_counted_once_until_they_are_removed(void **state)
{
    struct in_flight in_flight = {0};

    assign(&in_flight, 3, 0, 2);
    in_flight_mark_rendered(&in_flight, &in_flight.frames[0]);
    in_flight_mark_rendered(&in_flight, &in_flight.frames[0]);
    assert_int_equal(in_flight.rendered_count, 1);
    in_flight_remove(&in_flight, &in_flight.frames[0]);
    assert_int_equal(in_flight.rendered_count, 0);
    in_flight_finish(&in_flight);
}

static void the_current_job_is_that_of_the_frame_being_rendered(void **state)
{
    struct in_flight in_flight = {0};

    assert_int_equal(in_flight_current_job(&in_flight), 0);
    assert_null(in_flight_current(&in_flight));
    assign(&in_flight, 3, 0, 1);
    assign(&in_flight, 5, 0, 1);
    assert_int_equal(in_flight_current_job(&in_flight), 3);
    in_flight_mark_rendered(&in_flight, &in_flight.frames[0]);
    assert_int_equal(in_flight_current_job(&in_flight), 5);
    in_flight_mark_rendered(&in_flight, &in_flight.frames[1]);
    assert_int_equal(in_flight_current_job(&in_flight), 3);
    assert_true(in_flight_has_job(&in_flight, 5));
    assert_false(in_flight_has_job(&in_flight, 4));
    in_flight_finish(&in_flight);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_frame_is_found_by_job_number_and_attempt),
        cmocka_unit_test(removing_keeps_the_order_of_the_others),
        cmocka_unit_test(rendered_frames_are_counted_once_until_they_are_removed),
        cmocka_unit_test(the_current_job_is_that_of_the_frame_being_rendered),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
