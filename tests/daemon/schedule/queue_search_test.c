// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/queue_search.h"

#include "daemon/schedule/queue.h"

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
    struct frame_range range = {0};
    int32_t *indices;
    size_t count;

    if (text) assert_true(frame_range_parse(&range, text, NULL));
    count = queue_search_frames(job, states, text ? &range : NULL, &indices);
    assert_int_equal(count, expected_count);
    if (count > 0) assert_memory_equal(indices, expected, count * sizeof indices[0]);
    assert_int_equal(indices == NULL, count == 0);
    free(indices);
    frame_range_finish(&range);
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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(frames_are_found_in_the_order_of_their_indices)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
