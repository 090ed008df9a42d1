// SPDX-License-Identifier: Apache-2.0
#include "worker/process/assignment.h"

#include "core/base/alloc.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static void add_job(struct assignment *assignment, int64_t id)
{
    struct held_job *job = held_job_create();

    job->id = id;
    job->root = xstrdup("/out");
    assignment_add_job(assignment, job);
}

static void frames_start_in_the_order_assigned(void **state)
{
    struct assignment assignment = {0};
    struct assignment_frame *first, *second;

    add_job(&assignment, 1);
    add_job(&assignment, 2);
    assert_true(assignment_add_frame(&assignment, 1, 30, 1));
    assert_true(assignment_add_frame(&assignment, 2, 10, 4));
    first = assignment_start_frame(&assignment);
    second = assignment_start_frame(&assignment);
    assert_int_equal(first->frame, 30);
    assert_int_equal(second->frame, 10);
    assert_int_equal(second->attempt, 4);
    assert_int_equal(second->job->id, 2);
    assert_null(assignment_start_frame(&assignment));
    assignment_end_frame(&assignment, first);
    assignment_finish(&assignment);
}

static void frame_of_an_unknown_job_is_refused(void **state)
{
    struct assignment assignment = {0};

    assert_false(assignment_add_frame(&assignment, 1, 0, 1));
    add_job(&assignment, 1);
    assignment_forget_job(&assignment, 1);
    assert_false(assignment_add_frame(&assignment, 1, 0, 1));
    assert_null(assignment.jobs);
}

static void forgotten_job_lives_until_its_last_frame_ends(void **state)
{
    struct assignment assignment = {0};
    struct assignment_frame *frame;
    struct assignment_dropped dropped;

    add_job(&assignment, 1);
    assignment_add_frame(&assignment, 1, 5, 1);
    assignment_add_frame(&assignment, 1, 6, 1);
    frame = assignment_start_frame(&assignment);
    assignment_forget_job(&assignment, 1);
    assert_int_equal(frame->job->id, 1);
    assert_true(assignment_drop_waiting(&assignment, 1, &dropped));
    assert_non_null(assignment.jobs);
    assignment_end_frame(&assignment, frame);
    assert_null(assignment.jobs);
}

static void job_told_again_serves_the_frames_after_it(void **state)
{
    struct assignment assignment = {0};
    struct assignment_frame *before, *after;

    add_job(&assignment, 1);
    assignment_add_frame(&assignment, 1, 5, 1);
    before = assignment_start_frame(&assignment);
    add_job(&assignment, 1);
    assignment_add_frame(&assignment, 1, 6, 1);
    after = assignment_start_frame(&assignment);
    assert_ptr_not_equal(before->job, after->job);
    assert_true(before->job->is_forgotten);
    assignment_end_frame(&assignment, before);
    assert_ptr_equal(assignment.jobs, after->job);
    assert_null(assignment.jobs->next);
    assignment_finish(&assignment);
}

static void drop_gives_back_what_waits_and_no_more(void **state)
{
    struct assignment assignment = {0};
    struct assignment_frame *started;
    struct assignment_dropped dropped;

    add_job(&assignment, 1);
    add_job(&assignment, 2);
    for (int i = 0; i < 3; i++)
        assignment_add_frame(&assignment, 1, i, 7);
    assignment_add_frame(&assignment, 2, 50, 1);
    started = assignment_start_frame(&assignment);
    assert_true(assignment_drop_waiting(&assignment, 1, &dropped));
    assert_int_equal(dropped.frame, 1);
    assert_int_equal(dropped.attempt, 7);
    assert_true(assignment_drop_waiting(&assignment, 1, &dropped));
    assert_int_equal(dropped.frame, 2);
    assert_false(assignment_drop_waiting(&assignment, 1, &dropped));
    assert_false(started->is_unwanted);
    assert_true(assignment_drop_waiting(&assignment, ASSIGNMENT_ANY_JOB, &dropped));
    assert_int_equal(dropped.job, 2);
    assert_null(assignment_start_frame(&assignment));
    assignment_finish(&assignment);
}

static void only_the_jobs_own_started_frames_become_unwanted(void **state)
{
    struct assignment assignment = {0};
    struct assignment_frame *one, *two;

    add_job(&assignment, 1);
    add_job(&assignment, 2);
    assignment_add_frame(&assignment, 1, 0, 1);
    assignment_add_frame(&assignment, 2, 0, 1);
    assignment_add_frame(&assignment, 1, 1, 1);
    one = assignment_start_frame(&assignment);
    two = assignment_start_frame(&assignment);
    assignment_unwant_started(&assignment, 1);
    assert_true(one->is_unwanted);
    assert_false(two->is_unwanted);
    assert_false(assignment_start_frame(&assignment)->is_unwanted);
    assignment_finish(&assignment);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_start_in_the_order_assigned),
        cmocka_unit_test(frame_of_an_unknown_job_is_refused),
        cmocka_unit_test(forgotten_job_lives_until_its_last_frame_ends),
        cmocka_unit_test(job_told_again_serves_the_frames_after_it),
        cmocka_unit_test(drop_gives_back_what_waits_and_no_more),
        cmocka_unit_test(only_the_jobs_own_started_frames_become_unwanted),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
