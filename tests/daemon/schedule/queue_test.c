// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/queue.h"

#include "core/base/alloc.h"
#include "tests/daemon/schedule/retry_frames.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { MAX_ATTEMPTS = 3 };

static struct queue *new_queue(void)
{
    return queue_create(MAX_ATTEMPTS);
}

static struct queue_job *add_job(struct queue *queue, int64_t id, const char *frames, int priority)
{
    struct frame_range range = {0};

    assert_true(frame_range_parse(&range, frames, NULL));
    return queue_add_job(queue, &(struct queue_job_params){.id = id, .frames = &range, .priority = priority});
}

static size_t take(struct queue *queue, uint16_t worker, struct queue_ticket *tickets, size_t max)
{
    struct queue_job *next = queue_choose_job(queue, NULL);

    return next ? queue_take(next, worker, tickets, max) : 0;
}

static struct queue_ticket take_one(struct queue *queue)
{
    struct queue_ticket ticket = {0};

    assert_int_equal(take(queue, 1, &ticket, 1), 1);
    return ticket;
}

static void frames_are_taken_in_the_users_order(void **state)
{
    struct queue *queue = new_queue();
    struct queue_ticket tickets[8];
    const int32_t expected[] = {7, 3, 2, 1};

    add_job(queue, 1, "7,3-1", 50);
    assert_int_equal(take(queue, 9, tickets, 8), 4);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(tickets[i].frame, expected[i]);
        assert_int_equal(tickets[i].index, i);
        assert_int_equal(tickets[i].attempt, 1);
    }
    assert_int_equal(frame_states_at(&queue_first_job(queue)->states, 0).worker, 9);
    assert_int_equal(take(queue, 9, tickets, 8), 0);
    queue_destroy(queue);
}

static void higher_priority_goes_first_then_lower_id(void **state)
{
    struct queue *queue = new_queue();
    const int64_t expected[] = {3, 5, 1, 2, 4};

    add_job(queue, 1, "1", 50);
    add_job(queue, 2, "1", 50);
    add_job(queue, 3, "1", 90);
    add_job(queue, 4, "1", 0);
    add_job(queue, 5, "1", 90);
    for (int i = 0; i < 5; i++) {
        assert_int_equal(queue_choose_job(queue, NULL)->id, expected[i]);
        assert_int_equal(take_one(queue).job, expected[i]);
    }
    assert_null(queue_choose_job(queue, NULL));
    queue_destroy(queue);
}

static void one_take_is_of_one_job(void **state)
{
    struct queue *queue = new_queue();
    struct queue_ticket tickets[8];

    add_job(queue, 1, "1-2", 50);
    add_job(queue, 2, "1-2", 50);
    assert_int_equal(take(queue, 1, tickets, 8), 2);
    assert_int_equal(tickets[1].job, 1);
    queue_destroy(queue);
}

static void a_job_of_raised_priority_is_next(void **state)
{
    struct queue *queue = new_queue();

    add_job(queue, 1, "1-2", 50);
    queue_set_priority(queue, add_job(queue, 2, "1-2", 10), 60);
    assert_int_equal(take_one(queue).job, 2);
    queue_set_priority(queue, queue_find_job(queue, 2), 50);
    assert_int_equal(take_one(queue).job, 1);
    assert_int_equal(queue_first_job(queue)->id, 1);
    assert_int_equal(queue_first_job(queue)->next->id, 2);
    queue_destroy(queue);
}

static void paused_job_is_skipped_until_resumed(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "1-2", 50);

    add_job(queue, 2, "1-2", 50);
    queue_pause(queue, job);
    assert_int_equal(queue_job_state(job), JOB_PAUSED);
    assert_int_equal(take_one(queue).job, 2);
    queue_resume(queue, job);
    assert_int_equal(take_one(queue).job, 1);
    queue_destroy(queue);
}

static void job_runs_from_queued_to_succeeded(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "1-2", 50);
    struct queue_ticket ticket;

    assert_int_equal(queue_job_state(job), JOB_QUEUED);
    ticket = take_one(queue);
    assert_int_equal(queue_job_state(job), JOB_RUNNING);
    assert_true(queue_begin_publish(queue, &ticket));
    assert_true(queue_succeed(queue, &ticket));
    assert_int_equal(queue_job_state(job), JOB_RUNNING);
    ticket = take_one(queue);
    assert_true(queue_skip(queue, &ticket));
    assert_int_equal(queue_job_state(job), JOB_SUCCEEDED);
    assert_false(queue_job_is_live(job));
    assert_int_equal(queue_count(queue, FRAME_SUCCEEDED), 1);
    assert_int_equal(queue_count(queue, FRAME_SKIPPED), 1);
    queue_destroy(queue);
}

static void failed_frame_is_tried_three_times(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "5", 50);

    for (int attempt = 1; attempt <= MAX_ATTEMPTS; attempt++) {
        struct queue_ticket ticket = take_one(queue);
        bool is_final = false;

        assert_int_equal(ticket.attempt, attempt);
        assert_true(queue_fail(queue, &ticket, false, &is_final));
        assert_int_equal(is_final, attempt == MAX_ATTEMPTS);
    }
    assert_int_equal(job->states.counts[FRAME_FAILED], 1);
    assert_int_equal(queue_job_state(job), JOB_FAILED);
    queue_destroy(queue);
}

static void final_failure_needs_no_further_attempt(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "5", 50);
    struct queue_ticket ticket = take_one(queue);

    assert_true(queue_fail(queue, &ticket, true, NULL));
    assert_int_equal(frame_states_at(&job->states, 0).state, FRAME_FAILED);
    queue_destroy(queue);
}

static void returned_frame_keeps_its_tries_but_not_its_number(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "5", 50);

    for (int attempt = 1; attempt <= 10; attempt++) {
        struct queue_ticket ticket = take_one(queue);

        assert_int_equal(ticket.attempt, attempt);
        assert_true(queue_return(queue, &ticket));
    }
    assert_int_equal(frame_states_at(&job->states, 0).tries, 0);
    assert_int_equal(frame_states_at(&job->states, 0).state, FRAME_QUEUED);
    queue_destroy(queue);
}

static void returned_frames_come_before_later_ones(void **state)
{
    struct queue *queue = new_queue();
    struct queue_ticket tickets[5];

    add_job(queue, 1, "0-9", 50);
    assert_int_equal(take(queue, 1, tickets, 5), 5);
    assert_true(queue_return(queue, &tickets[3]));
    assert_true(queue_return(queue, &tickets[1]));
    assert_int_equal(take_one(queue).frame, 1);
    assert_int_equal(take_one(queue).frame, 3);
    assert_int_equal(take_one(queue).frame, 5);
    queue_destroy(queue);
}

static void late_report_owns_nothing(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "5", 50);
    struct queue_ticket late = take_one(queue);
    struct queue_ticket current;
    bool is_final;

    assert_true(queue_return(queue, &late));
    for (int round = 0; round < 2; round++) {
        assert_false(queue_owns(queue, &late));
        assert_false(queue_begin_publish(queue, &late));
        assert_false(queue_succeed(queue, &late));
        assert_false(queue_skip(queue, &late));
        assert_false(queue_fail(queue, &late, true, &is_final));
        assert_false(queue_return(queue, &late));
        if (round == 0) current = take_one(queue);
    }
    assert_true(queue_owns(queue, &current));
    assert_int_equal(frame_states_at(&job->states, 0).state, FRAME_RUNNING);
    queue_destroy(queue);
}

static void frame_is_published_once(void **state)
{
    struct queue *queue = new_queue();
    struct queue_ticket ticket;

    add_job(queue, 1, "5", 50);
    ticket = take_one(queue);
    assert_true(queue_begin_publish(queue, &ticket));
    assert_false(queue_begin_publish(queue, &ticket));
    assert_true(queue_succeed(queue, &ticket));
    assert_false(queue_begin_publish(queue, &ticket));
    queue_destroy(queue);
}

static void cancel_takes_all_frames_but_those_being_published(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "1-4", 50);
    struct queue_ticket done = take_one(queue);
    struct queue_ticket publishing = take_one(queue);
    struct queue_ticket running = take_one(queue);

    assert_true(queue_succeed(queue, &done));
    assert_true(queue_begin_publish(queue, &publishing));
    queue_cancel(queue, job);
    assert_int_equal(queue_job_state(job), JOB_CANCELED);
    assert_int_equal(job->states.counts[FRAME_CANCELED], 2);
    assert_false(queue_owns(queue, &running));
    assert_null(queue_choose_job(queue, NULL));
    assert_true(queue_succeed(queue, &publishing));
    assert_int_equal(job->states.counts[FRAME_SUCCEEDED], 2);
    queue_destroy(queue);
}

static void failed_publishing_ends_with_its_canceled_job(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "1", 50);
    struct queue_ticket ticket = take_one(queue);
    bool is_final = false;

    assert_true(queue_begin_publish(queue, &ticket));
    queue_cancel(queue, job);
    assert_true(queue_fail(queue, &ticket, false, &is_final));
    assert_true(is_final);
    assert_int_equal(frame_states_at(&job->states, 0).state, FRAME_CANCELED);
    queue_destroy(queue);
}

static void failed_job_fails_its_frames(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "1-3", 50);
    struct queue_ticket ticket = take_one(queue);

    queue_fail_job(queue, job);
    assert_int_equal(job->states.counts[FRAME_FAILED], 3);
    assert_int_equal(queue_job_state(job), JOB_FAILED);
    assert_false(queue_owns(queue, &ticket));
    queue_destroy(queue);
}

static void ended_job_cannot_be_canceled(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "1", 50);
    struct queue_ticket ticket = take_one(queue);

    assert_true(queue_succeed(queue, &ticket));
    queue_cancel(queue, job);
    assert_int_equal(queue_job_state(job), JOB_SUCCEEDED);
    queue_destroy(queue);
}

static void retry_gives_failed_frames_all_their_attempts(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "1-2", 50);
    struct queue_ticket ticket = take_one(queue);
    bool is_final = true;

    assert_true(queue_fail(queue, &ticket, true, NULL));
    assert_int_equal(retry_frames(job, 1u << FRAME_FAILED, NULL), 1);
    for (int attempt = 2; attempt <= 1 + MAX_ATTEMPTS; attempt++) {
        ticket = take_one(queue);
        assert_int_equal(ticket.frame, 1);
        assert_int_equal(ticket.attempt, attempt);
        assert_true(queue_fail(queue, &ticket, false, &is_final));
        assert_int_equal(is_final, attempt == 1 + MAX_ATTEMPTS);
    }
    queue_destroy(queue);
}

static void a_retried_canceled_job_is_live_again(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "1-10", 50);

    queue_cancel(queue, job);
    assert_int_equal(retry_frames(job, 1u << FRAME_CANCELED, "9,3,200"), 2);
    assert_int_equal(queue_job_state(job), JOB_RUNNING);
    assert_int_equal(take_one(queue).frame, 3);
    assert_int_equal(take_one(queue).frame, 9);
    assert_null(queue_choose_job(queue, NULL));
    queue_destroy(queue);
}

// It ends while paused, when its last frame fails or somebody cancels it. Nobody can resume it then.
static void a_retried_job_that_was_paused_when_it_ended_runs(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "1-2", 50);
    struct queue_ticket first = take_one(queue), second = take_one(queue);

    assert_true(queue_fail(queue, &first, true, NULL));
    queue_pause(queue, job);
    assert_true(queue_fail(queue, &second, true, NULL));
    assert_int_equal(queue_job_state(job), JOB_FAILED);
    assert_int_equal(retry_frames(job, 1u << FRAME_FAILED, NULL), 2);
    assert_int_equal(queue_job_state(job), JOB_QUEUED);
    queue_pause(queue, job);
    queue_cancel(queue, job);
    assert_int_equal(retry_frames(job, 1u << FRAME_CANCELED, NULL), 2);
    assert_int_equal(take_one(queue).frame, 1);
    queue_destroy(queue);
}

static void a_live_job_stays_paused_when_it_is_retried(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "1-2", 50);
    struct queue_ticket ticket = take_one(queue);

    assert_true(queue_fail(queue, &ticket, true, NULL));
    queue_pause(queue, job);
    assert_int_equal(retry_frames(job, 1u << FRAME_FAILED, NULL), 1);
    assert_int_equal(queue_job_state(job), JOB_PAUSED);
    queue_destroy(queue);
}

static void retry_of_nothing_changes_nothing(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "1-2", 50);

    take_one(queue);
    assert_int_equal(retry_frames(job, 1u << FRAME_QUEUED | 1u << FRAME_RUNNING, NULL), 0);
    queue_cancel(queue, job);
    assert_int_equal(retry_frames(job, 1u << FRAME_FAILED, NULL), 0);
    assert_int_equal(queue_job_state(job), JOB_CANCELED);
    queue_destroy(queue);
}

static void restored_frames_are_not_taken_again(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "1-3", 50);

    queue_restore_frame(job, 0, FRAME_SUCCEEDED, 2);
    queue_restore_frame(job, 2, FRAME_FAILED, 3);
    assert_int_equal(queue_job_state(job), JOB_RUNNING);
    assert_int_equal(take_one(queue).frame, 2);
    assert_null(queue_choose_job(queue, NULL));
    queue_destroy(queue);
}

static void restored_cancel_holds_for_a_job_whose_frames_all_succeeded(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *canceled = add_job(queue, 1, "1", 50);
    struct queue_job *partly = add_job(queue, 2, "1-3", 50);

    queue_restore_frame(canceled, 0, FRAME_SUCCEEDED, 1);
    queue_restore_end(canceled, true, false);
    assert_int_equal(queue_job_state(canceled), JOB_CANCELED);
    assert_int_equal(canceled->states.counts[FRAME_SUCCEEDED], 1);
    queue_restore_frame(partly, 0, FRAME_SUCCEEDED, 1);
    queue_restore_end(partly, false, true);
    assert_int_equal(queue_job_state(partly), JOB_FAILED);
    assert_int_equal(partly->states.counts[FRAME_FAILED], 2);
    assert_null(queue_choose_job(queue, NULL));
    queue_destroy(queue);
}

static void counts_of_a_removed_job_are_subtracted(void **state)
{
    struct queue *queue = new_queue();
    struct queue_job *job = add_job(queue, 1, "1-3", 50);
    struct queue_ticket ticket = take_one(queue);

    add_job(queue, 2, "1-2", 50);
    queue_remove_job(queue, job);
    assert_null(queue_find_job(queue, 1));
    assert_false(queue_owns(queue, &ticket));
    assert_int_equal(queue_count(queue, FRAME_RUNNING), 0);
    assert_int_equal(queue_count(queue, FRAME_QUEUED), 2);
    assert_int_equal(take_one(queue).job, 2);
    queue_destroy(queue);
}

static void hundred_thousand_jobs_are_quick_to_use(void **state)
{
    // The test exceeds its time limit if adding, finding or taking visits all jobs.
    enum { JOB_COUNT = 100 * 1000 };
    struct queue *queue = new_queue();

    for (int64_t id = 1; id <= JOB_COUNT; id++)
        add_job(queue, id, "1", (int)(id * 37 % QUEUE_PRIORITY_LIMIT));
    for (int64_t id = 1; id <= JOB_COUNT; id++) {
        struct queue_ticket ticket = take_one(queue);

        assert_non_null(queue_find_job(queue, id));
        assert_true(queue_succeed(queue, &ticket));
    }
    assert_int_equal(queue_count(queue, FRAME_SUCCEEDED), JOB_COUNT);
    queue_destroy(queue);
}

static void million_frames_need_little_memory(void **state)
{
    assert_true(sizeof(struct queue_frame) <= 16);
}

static void state_names_follow_the_enumerations(void **state)
{
    assert_string_equal(job_state_name(JOB_PAUSED), "paused");
    assert_string_equal(job_state_name(JOB_CANCELED), "canceled");
    assert_string_equal(frame_state_name(FRAME_QUEUED), "queued");
    assert_string_equal(frame_state_name(FRAME_SKIPPED), "skipped");
    assert_null(job_state_names[JOB_STATE_COUNT]);
    assert_null(frame_state_names[FRAME_STATE_COUNT]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_are_taken_in_the_users_order),
        cmocka_unit_test(higher_priority_goes_first_then_lower_id),
        cmocka_unit_test(one_take_is_of_one_job),
        cmocka_unit_test(a_job_of_raised_priority_is_next),
        cmocka_unit_test(paused_job_is_skipped_until_resumed),
        cmocka_unit_test(job_runs_from_queued_to_succeeded),
        cmocka_unit_test(failed_frame_is_tried_three_times),
        cmocka_unit_test(final_failure_needs_no_further_attempt),
        cmocka_unit_test(returned_frame_keeps_its_tries_but_not_its_number),
        cmocka_unit_test(returned_frames_come_before_later_ones),
        cmocka_unit_test(late_report_owns_nothing),
        cmocka_unit_test(frame_is_published_once),
        cmocka_unit_test(cancel_takes_all_frames_but_those_being_published),
        cmocka_unit_test(failed_publishing_ends_with_its_canceled_job),
        cmocka_unit_test(failed_job_fails_its_frames),
        cmocka_unit_test(ended_job_cannot_be_canceled),
        cmocka_unit_test(retry_gives_failed_frames_all_their_attempts),
        cmocka_unit_test(a_retried_canceled_job_is_live_again),
        cmocka_unit_test(a_retried_job_that_was_paused_when_it_ended_runs),
        cmocka_unit_test(a_live_job_stays_paused_when_it_is_retried),
        cmocka_unit_test(retry_of_nothing_changes_nothing),
        cmocka_unit_test(restored_frames_are_not_taken_again),
        cmocka_unit_test(restored_cancel_holds_for_a_job_whose_frames_all_succeeded),
        cmocka_unit_test(counts_of_a_removed_job_are_subtracted),
        cmocka_unit_test(hundred_thousand_jobs_are_quick_to_use),
        cmocka_unit_test(million_frames_need_little_memory),
        cmocka_unit_test(state_names_follow_the_enumerations),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
