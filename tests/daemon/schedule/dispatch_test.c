// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/dispatch.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static size_t count_for(double frame_s, int64_t left, int workers, size_t in_flight)
{
    return dispatch_count(
        &(struct dispatch_load){.frame_s = frame_s, .left = left, .workers = workers, .in_flight = in_flight});
}

static void unknown_duration_gives_one_frame(void **state)
{
    assert_int_equal(count_for(0, 1000000, 2, 0), 1);
    assert_int_equal(count_for(0, 1000000, 2, 1), 0);
}

static void long_frames_are_assigned_one_by_one(void **state)
{
    assert_int_equal(count_for(10, 1000, 2, 0), 1);
    assert_int_equal(count_for(10, 1000, 2, 1), 0);
    assert_int_equal(count_for(1e9, 1000, 2, 0), 1);
}

static void chunk_keeps_overhead_under_one_percent(void **state)
{
    const double overhead_s = 1e-3;

    for (double frame_s = 5e-4; frame_s < 20; frame_s *= 1.1) {
        size_t chunk = count_for(frame_s, 1000000, 1, 0);

        assert_true(overhead_s <= 0.01 * (double)chunk * frame_s);
    }
}

static void more_overhead_makes_larger_chunks(void **state)
{
    struct dispatch_load load = {.frame_s = 1, .overhead_s = 0.02, .left = 1000, .workers = 1};

    assert_int_equal(dispatch_count(&load), 10);
}

static void shortest_frames_reach_the_limit(void **state)
{
    assert_int_equal(count_for(1e-6, 1000000, 2, 0), DISPATCH_CHUNK_LIMIT);
    assert_int_equal(count_for(1e-300, 1000000, 2, 0), DISPATCH_CHUNK_LIMIT);
}

static void many_workers_share_a_limit(void **state)
{
    const struct dispatch_load skips = {.skip_run = 1000, .skip_s = 1e-6, .left = 1000000, .workers = 1000};

    assert_int_equal(count_for(1e-6, 1000000, 200, 0), DISPATCH_LIMIT / 200);
    assert_int_equal(count_for(1e-6, 1000000, DISPATCH_LIMIT + 1, 0), 1);
    assert_int_equal(dispatch_count(&skips), DISPATCH_LIMIT / 1000);
}

static void worker_gets_more_when_half_of_a_chunk_is_rendered(void **state)
{
    assert_int_equal(count_for(1e-6, 1000000, 2, DISPATCH_CHUNK_LIMIT / 2 + 1), 0);
    assert_int_equal(count_for(1e-6, 1000000, 2, DISPATCH_CHUNK_LIMIT / 2), DISPATCH_CHUNK_LIMIT / 2);
}

static void no_frame_is_begun_that_does_not_end(void **state)
{
    assert_true(dispatch_count_fitting(0, 1, 0) == SIZE_MAX);
    assert_true(dispatch_count_fitting(5, HUGE_VAL, 3) == SIZE_MAX);
    assert_int_equal(dispatch_count_fitting(5, 14.9, 0), 2);
    assert_int_equal(dispatch_count_fitting(5, 14.9, 1), 1);
    assert_int_equal(dispatch_count_fitting(5, 14.9, 2), 0);
    assert_int_equal(dispatch_count_fitting(5, 14.9, 3), 0);
    assert_int_equal(dispatch_count_fitting(5, -1, 0), 0);
    assert_int_equal(dispatch_count_fitting(0, 0, 0), 0);
    assert_int_equal(dispatch_count_fitting(1e-9, 1e9, 0), DISPATCH_CHUNK_LIMIT);
}

static void the_last_frames_of_a_job_are_shared(void **state)
{
    assert_int_equal(count_for(1e-6, 100, 4, 0), 13); // a half of 25, rounded up
    assert_int_equal(count_for(1e-6, 2, 4, 0), 1);
    assert_int_equal(count_for(1e-6, 1, 1, 0), 1);
}

static void no_worker_gets_more_than_is_left(void **state)
{
    for (int64_t left = 0; left < 600; left++)
        assert_true((int64_t)count_for(1e-6, left, 1, 0) <= left);
    assert_int_equal(count_for(1e-6, 0, 1, 0), 0);
}

static void idle_worker_always_gets_a_frame(void **state)
{
    for (double frame_s = 1e-6; frame_s < 1e6; frame_s *= 10)
        for (int workers = 1; workers < 1000; workers *= 3)
            assert_true(count_for(frame_s, 1, workers, 0) == 1);
}

static size_t count_behind(double other_jobs_s, double frame_s)
{
    return dispatch_count(
        &(struct dispatch_load){.frame_s = frame_s, .left = 1000000, .workers = 2, .other_jobs_s = other_jobs_s});
}

static void frame_of_another_job_counts_by_its_length(void **state)
{
    const double frame_s = 1e-6;

    assert_int_equal(count_behind(10 * frame_s, frame_s), DISPATCH_CHUNK_LIMIT - 10);
    assert_int_equal(count_behind(0.5 * DISPATCH_CHUNK_LIMIT * frame_s * 1.01, frame_s), 0);
    assert_int_equal(count_behind(60, frame_s), 0);
    assert_int_equal(count_behind(frame_s, 60), 0);
}

static void no_frame_waits_behind_another_job_of_unknown_length(void **state)
{
    assert_int_equal(count_behind(HUGE_VAL, 1e-6), 0);
    assert_int_equal(count_behind(HUGE_VAL, 10), 0);
    assert_int_equal(count_behind(HUGE_VAL, 0), 0);
    assert_int_equal(count_behind(1e-6, 0), 0);
}

static size_t count_after_skips(double frame_s, size_t skip_run)
{
    return dispatch_count(&(struct dispatch_load){
        .frame_s = frame_s, .skip_s = 1e-3, .skip_run = skip_run, .left = 1000000, .workers = 2});
}

static void chunks_of_skipped_frames_grow_with_their_number(void **state)
{
    for (int frame_s = 0; frame_s <= 60; frame_s += 60) {
        assert_int_equal(count_after_skips(frame_s, 0), 1);
        assert_int_equal(count_after_skips(frame_s, 1), 2);
        assert_int_equal(count_after_skips(frame_s, 20), 40);
        assert_true(count_after_skips(frame_s, 10000) > 100);
        assert_true(count_after_skips(frame_s, 10000) <= DISPATCH_CHUNK_LIMIT);
    }
}

static void chunk_of_skipped_frames_is_too_much_once_one_is_rendered(void **state)
{
    assert_true(dispatch_is_overfull(0, 127));
    assert_true(dispatch_is_overfull(60, 127));
    assert_false(dispatch_is_overfull(60, 2));
    assert_false(dispatch_is_overfull(1e-6, DISPATCH_CHUNK_LIMIT));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(unknown_duration_gives_one_frame),
        cmocka_unit_test(long_frames_are_assigned_one_by_one),
        cmocka_unit_test(chunk_keeps_overhead_under_one_percent),
        cmocka_unit_test(more_overhead_makes_larger_chunks),
        cmocka_unit_test(shortest_frames_reach_the_limit),
        cmocka_unit_test(many_workers_share_a_limit),
        cmocka_unit_test(worker_gets_more_when_half_of_a_chunk_is_rendered),
        cmocka_unit_test(no_frame_is_begun_that_does_not_end),
        cmocka_unit_test(the_last_frames_of_a_job_are_shared),
        cmocka_unit_test(no_worker_gets_more_than_is_left),
        cmocka_unit_test(idle_worker_always_gets_a_frame),
        cmocka_unit_test(frame_of_another_job_counts_by_its_length),
        cmocka_unit_test(chunks_of_skipped_frames_grow_with_their_number),
        cmocka_unit_test(chunk_of_skipped_frames_is_too_much_once_one_is_rendered),
        cmocka_unit_test(no_frame_waits_behind_another_job_of_unknown_length),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
