// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/queue.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void job_whose_last_frames_are_being_published_has_none_to_cancel(void **state)
{
    struct queue *queue = queue_create(3);
    struct queue_ticket tickets[2];
    struct frame_range range = {0};
    struct queue_job *job;

    assert_true(frame_range_parse(&range, "1-3", NULL));
    job = queue_add_job(queue, &(struct queue_job_params){.id = 1, .frames = &range, .priority = 50});
    assert_int_equal(queue_take(job, 1, tickets, 2), 2);
    for (int i = 0; i < 2; i++)
        assert_true(queue_begin_publish(queue, &tickets[i]));
    assert_true(queue_has_frame_to_cancel(job)); // frame 3 is queued
    assert_true(queue_succeed(queue, &tickets[0]));
    assert_int_equal(queue_take(job, 1, tickets, 1), 1);
    assert_true(queue_has_frame_to_cancel(job)); // it is being rendered
    assert_true(queue_begin_publish(queue, &tickets[0]));
    assert_false(queue_has_frame_to_cancel(job));
    queue_destroy(queue);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(job_whose_last_frames_are_being_published_has_none_to_cancel),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
