// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/queue_search.h"

#include "daemon/schedule/queue.h"
#include "tests/daemon/schedule/retry_frames.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

// The job "0-19,30,25" of which frames 3, 4, 7, 30 and 25 (indices 20 and 21) failed and 5 succeeded.
static struct queue_job *make_job(struct queue *queue)
{
    static const int failed[] = {3, 4, 7, 20, 21};
    struct frame_range frames;
    struct queue_job *job;

    assert_true(frame_range_parse(&frames, "0-19,30,25", NULL));
    job = queue_add_job(queue, &(struct queue_job_params){.id = 1, .frames = &frames, .priority = 50});
    for (size_t i = 0; i < sizeof failed / sizeof failed[0]; i++)
        queue_restore_frame(job, failed[i], FRAME_FAILED, 3);
    queue_restore_frame(job, 5, FRAME_SUCCEEDED, 1);
    return job;
}

static void assert_found(const struct queue_job *job, unsigned states, const char *text, const int32_t *expected,
                         size_t expected_count)
{
    struct frame_set numbers = {0}, found;
    int64_t at = -1;

    if (text) assert_true(frame_set_parse(&numbers, text, NULL));
    assert_int_equal(queue_search_frames(job, states, text ? &numbers : NULL, &found), expected_count);
    for (size_t i = 0; i < expected_count; i++) {
        at = frame_set_next(&found, at + 1);
        assert_int_equal(at, expected[i]);
    }
    assert_int_equal(frame_set_next(&found, at + 1), found.limit);
    frame_set_finish(&found);
    frame_set_finish(&numbers);
}

static void frames_are_found_in_the_order_of_their_indices(void **state)
{
    struct queue *queue = queue_create(3);
    const struct queue_job *job = make_job(queue);
    const unsigned failed = 1u << FRAME_FAILED;

    assert_found(job, failed, NULL, (const int32_t[]){3, 4, 7, 20, 21}, 5);
    assert_found(job, failed, "25,30,7-4,99", (const int32_t[]){4, 7, 20, 21}, 4); // fewer frames than the job's
    assert_found(job, failed, "30-5", (const int32_t[]){7, 20, 21}, 3);            // more
    assert_found(job, failed | 1u << FRAME_SUCCEEDED, "0-5", (const int32_t[]){3, 4, 5}, 3);
    assert_found(job, failed, "5", NULL, 0);
    assert_found(job, 1u << FRAME_QUEUED | 1u << FRAME_CANCELED, NULL, NULL, 0); // queued ones are no candidates
    queue_destroy(queue);
}

// No call looks at all frames of a large job.
static void the_search_for_a_far_frame_goes_on(void **state)
{
    struct queue *queue = queue_create(3);
    struct frame_range frames;
    struct queue_job *job;
    struct queue_ticket tickets[2];
    int calls = 1;

    assert_true(frame_range_parse(&frames, "0-299999", NULL));
    job = queue_add_job(queue, &(struct queue_job_params){.id = 1, .frames = &frames, .priority = 50});
    queue_cancel(queue, job);
    assert_int_equal(retry_frames(job, 1u << FRAME_CANCELED, "299998,299999"), 2);
    while (queue_take(job, 9, tickets, 2) == 0)
        calls++;
    assert_in_range(calls, 3, 4);
    assert_int_equal(tickets[0].frame, 299998);
    assert_int_equal(tickets[1].frame, 299999);
    queue_destroy(queue);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_are_found_in_the_order_of_their_indices),
        cmocka_unit_test(the_search_for_a_far_frame_goes_on),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
