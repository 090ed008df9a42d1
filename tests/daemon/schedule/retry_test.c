// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/retry.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void frame_is_tried_until_its_attempts_are_used(void **state)
{
    assert_int_equal(retry_decide(RETRY_FAULT_FRAME, true, 1, 3), RETRY_FRAME);
    assert_int_equal(retry_decide(RETRY_FAULT_FRAME, true, 2, 3), RETRY_FRAME);
    assert_int_equal(retry_decide(RETRY_FAULT_FRAME, true, 3, 3), RETRY_FAIL_FRAME);
}

static void the_started_frame_of_a_lost_worker_loses_an_attempt(void **state)
{
    assert_int_equal(retry_decide(RETRY_FAULT_LOST, true, 1, 3), RETRY_FRAME);
    assert_int_equal(retry_decide(RETRY_FAULT_LOST, true, 3, 3), RETRY_FAIL_FRAME);
    assert_int_equal(retry_decide(RETRY_FAULT_WORKER, true, 3, 3), RETRY_FAIL_FRAME);
}

static void frames_not_started_are_not_to_blame(void **state)
{
    assert_int_equal(retry_decide(RETRY_FAULT_LOST, false, 3, 3), RETRY_FREE);
    assert_int_equal(retry_decide(RETRY_FAULT_WORKER, false, 3, 3), RETRY_FREE);
}

static void code_of_the_user_that_does_not_end_gets_one_attempt(void **state)
{
    assert_int_equal(retry_decide(RETRY_FAULT_ENDLESS, true, 1, 3), RETRY_FAIL_FRAME);
    assert_int_equal(retry_decide(RETRY_FAULT_ENDLESS, false, 1, 3), RETRY_FREE);
    assert_int_equal(retry_decide(RETRY_FAULT_CUT, true, 1, 3), RETRY_FAIL_FRAME);
    assert_int_equal(retry_decide(RETRY_FAULT_MISSED, true, 1, 3), RETRY_FAIL_FRAME);
    assert_int_equal(retry_decide(RETRY_FAULT_MISSED, false, 1, 3), RETRY_FREE);
}

static void a_job_of_endless_frames_only_is_failed(void **state)
{
    assert_false(retry_gives_up_job(RETRY_HOPELESS_LIMIT - 1, 0));
    assert_true(retry_gives_up_job(RETRY_HOPELESS_LIMIT, 0));
    assert_false(retry_gives_up_job(100, 1));
}

static void job_fault_fails_the_job_at_once(void **state)
{
    assert_int_equal(retry_decide(RETRY_FAULT_JOB, true, 1, 3), RETRY_FAIL_JOB);
}

static void output_fault_pauses_and_never_uses_up_a_frame(void **state)
{
    assert_int_equal(retry_decide(RETRY_FAULT_OUTPUT, true, 1, 3), RETRY_PAUSE_JOB);
    assert_int_equal(retry_decide(RETRY_FAULT_OUTPUT, true, 3, 3), RETRY_PAUSE_JOB);
    assert_int_equal(retry_decide(RETRY_FAULT_ROOT, true, 3, 3), RETRY_AWAIT_ROOT);
    assert_false(retry_blames_host(RETRY_FAULT_ROOT));
}

static void a_worker_of_another_job_is_blamed_for_what_depends_on_the_worker(void **state)
{
    assert_true(retry_blames_host(RETRY_FAULT_JOB));
    assert_true(retry_blames_host(RETRY_FAULT_FRAME));
    assert_true(retry_blames_host(RETRY_FAULT_WORKER));
    assert_true(retry_blames_host(RETRY_FAULT_OUTPUT));
    assert_true(retry_blames_host(RETRY_FAULT_LOST));
    assert_false(retry_blames_host(RETRY_FAULT_ENDLESS));
    assert_false(retry_blames_host(RETRY_FAULT_CUT));
    assert_false(retry_blames_host(RETRY_FAULT_MISSED));
}

static void fault_names_follow_the_enumeration(void **state)
{
    assert_string_equal(retry_fault_names[RETRY_FAULT_JOB], "job");
    assert_string_equal(retry_fault_names[RETRY_FAULT_FRAME], "frame");
    assert_string_equal(retry_fault_names[RETRY_FAULT_WORKER], "worker");
    assert_string_equal(retry_fault_names[RETRY_FAULT_OUTPUT], "output");
    assert_string_equal(retry_fault_names[RETRY_FAULT_LOST], "lost");
    assert_string_equal(retry_fault_names[RETRY_FAULT_ENDLESS], "endless");
    assert_string_equal(retry_fault_names[RETRY_FAULT_CUT], "cut");
    assert_string_equal(retry_fault_names[RETRY_FAULT_MISSED], "missed");
    assert_null(retry_fault_names[RETRY_FAULT_MISSED + 1]);
}

static void backoff_doubles_up_to_a_minute(void **state)
{
    const int64_t expected_ms[] = {1000, 2000, 4000, 8000, 16000, 32000, 60000, 60000};
    struct retry_backoff backoff = {0};

    for (size_t i = 0; i < sizeof expected_ms / sizeof expected_ms[0]; i++) {
        retry_backoff_fail(&backoff, 5000);
        assert_int_equal(retry_backoff_wait_ms(&backoff, 5000), expected_ms[i]);
    }
    for (int i = 0; i < 1000; i++)
        retry_backoff_fail(&backoff, 5000);
    assert_int_equal(retry_backoff_wait_ms(&backoff, 5000), 60000);
}

static void backoff_ends_with_time_or_success(void **state)
{
    struct retry_backoff backoff = {0};

    assert_int_equal(retry_backoff_wait_ms(&backoff, 0), 0);
    retry_backoff_fail(&backoff, 0);
    assert_int_equal(retry_backoff_wait_ms(&backoff, 400), 600);
    assert_int_equal(retry_backoff_wait_ms(&backoff, 1000), 0);

    retry_backoff_fail(&backoff, 1000);
    retry_backoff_succeed(&backoff);
    assert_int_equal(retry_backoff_wait_ms(&backoff, 1000), 0);
    retry_backoff_fail(&backoff, 1000);
    assert_int_equal(retry_backoff_wait_ms(&backoff, 1000), 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frame_is_tried_until_its_attempts_are_used),
        cmocka_unit_test(the_started_frame_of_a_lost_worker_loses_an_attempt),
        cmocka_unit_test(frames_not_started_are_not_to_blame),
        cmocka_unit_test(code_of_the_user_that_does_not_end_gets_one_attempt),
        cmocka_unit_test(a_job_of_endless_frames_only_is_failed),
        cmocka_unit_test(job_fault_fails_the_job_at_once),
        cmocka_unit_test(output_fault_pauses_and_never_uses_up_a_frame),
        cmocka_unit_test(a_worker_of_another_job_is_blamed_for_what_depends_on_the_worker),
        cmocka_unit_test(fault_names_follow_the_enumeration),
        cmocka_unit_test(backoff_doubles_up_to_a_minute),
        cmocka_unit_test(backoff_ends_with_time_or_success),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
