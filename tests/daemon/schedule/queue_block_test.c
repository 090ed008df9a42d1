// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/queue.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void blocked_job_is_skipped_and_a_pause_outlasts_the_block(void **state)
{
    struct queue *queue = queue_create(3);
    struct frame_range range = {0};
    struct queue_job *job;

    assert_true(frame_range_parse(&range, "1-2", NULL));
    job = queue_add_job(queue, &(struct queue_job_params){.id = 1, .frames = &range, .priority = 50});
    queue_set_block(queue, job, QUEUE_IN_DOUBT);
    assert_null(queue_choose_job(queue, NULL));
    assert_int_equal(queue_job_state(job), JOB_QUEUED);
    queue_set_block(queue, job, QUEUE_AWAY);
    assert_null(queue_choose_job(queue, NULL));
    assert_int_equal(queue_job_state(job), JOB_PAUSED);
    queue_set_block(queue, job, QUEUE_OPEN);
    assert_ptr_equal(queue_choose_job(queue, NULL), job);
    queue_pause(queue, job);
    queue_set_block(queue, job, QUEUE_AWAY);
    queue_set_block(queue, job, QUEUE_OPEN);
    assert_null(queue_choose_job(queue, NULL));
    assert_int_equal(queue_job_state(job), JOB_PAUSED);
    queue_destroy(queue);
}

static void job_that_waits_for_others_is_skipped_and_a_pause_outlasts_the_wait(void **state)
{
    struct queue *queue = queue_create(3);
    struct frame_range range = {0};
    struct queue_ticket ticket;
    struct queue_job *job;

    assert_true(frame_range_parse(&range, "1-2", NULL));
    job = queue_add_job(queue, &(struct queue_job_params){.id = 1, .frames = &range, .priority = 50, .waits = true});
    assert_null(queue_choose_job(queue, NULL));
    assert_int_equal(queue_take(job, 1, &ticket, 1), 0);
    assert_int_equal(queue_job_state(job), JOB_QUEUED);
    queue_set_wait(job, QUEUE_WAITS_IN_VAIN);
    assert_null(queue_choose_job(queue, NULL));
    assert_int_equal(queue_job_state(job), JOB_PAUSED);
    queue_pause(queue, job);
    queue_set_wait(job, QUEUE_WAITS_NOT);
    assert_int_equal(queue_job_state(job), JOB_PAUSED);
    queue_resume(queue, job);
    assert_ptr_equal(queue_choose_job(queue, NULL), job);
    queue_set_wait(job, QUEUE_WAITS_IN_VAIN);
    queue_cancel(queue, job);
    assert_int_equal(queue_job_state(job), JOB_CANCELED);
    queue_destroy(queue);
}

// Frames 1 to 3 were taken and came back, and the file of the second turns out to be published.
static void frame_that_turns_out_to_be_published_is_not_taken_again(void **state)
{
    struct queue *queue = queue_create(3);
    struct frame_range range = {0};
    struct queue_ticket tickets[3];
    struct queue_job *job;

    assert_true(frame_range_parse(&range, "1-3", NULL));
    job = queue_add_job(queue, &(struct queue_job_params){.id = 1, .frames = &range, .priority = 50});
    assert_int_equal(queue_take(job, 1, tickets, 3), 3);
    assert_false(queue_find_published(job, 1));
    for (int i = 0; i < 3; i++)
        assert_true(queue_return(queue, &tickets[i]));
    assert_true(queue_find_published(job, 1));
    assert_false(queue_find_published(job, 1));
    assert_int_equal(queue_take(job, 1, tickets, 3), 2);
    assert_int_equal(tickets[0].frame, 1);
    assert_int_equal(tickets[1].frame, 3);
    assert_int_equal(job->states.counts[FRAME_SUCCEEDED], 1);
    queue_destroy(queue);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocked_job_is_skipped_and_a_pause_outlasts_the_block),
        cmocka_unit_test(job_that_waits_for_others_is_skipped_and_a_pause_outlasts_the_wait),
        cmocka_unit_test(frame_that_turns_out_to_be_published_is_not_taken_again),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
