// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/liveness.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static char reason[LIVENESS_REASON_SIZE];

// Checks every second until `until_ms`; with `beats` a heartbeat of unchanged progress comes before each check.
static enum liveness_verdict run_until(struct liveness *liveness, int64_t until_ms, bool beats, double median_s,
                                       size_t known)
{
    enum liveness_verdict verdict = LIVENESS_ALIVE;

    for (int64_t now_ms = liveness->checked_ms + 1000; now_ms <= until_ms && verdict == LIVENESS_ALIVE;
         now_ms += 1000) {
        if (beats) liveness_progress(liveness, 7, now_ms);
        verdict =
            liveness_check(liveness, &(struct liveness_job){.median_s = median_s, .known = known}, now_ms, reason);
    }
    return verdict;
}

static struct liveness ready_worker(void)
{
    struct liveness liveness = {0};

    liveness_start(&liveness, 0);
    liveness_ready(&liveness, 0);
    return liveness;
}

static void worker_must_be_ready_within_thirty_seconds(void **state)
{
    struct liveness liveness = {0};

    liveness_start(&liveness, 0);
    assert_int_equal(run_until(&liveness, 30000, false, 0, 0), LIVENESS_ALIVE);
    assert_int_equal(run_until(&liveness, 31000, false, 0, 0), LIVENESS_NO_START);
    assert_string_equal(reason, "not ready 30 s after its start");
}

static void silent_worker_is_found_after_ten_seconds(void **state)
{
    struct liveness liveness = ready_worker();

    assert_int_equal(run_until(&liveness, 10000, false, 0, 0), LIVENESS_ALIVE);
    assert_int_equal(run_until(&liveness, 11000, false, 0, 0), LIVENESS_SILENT);
    assert_string_equal(reason, "no message for 10 s");
}

static void any_message_is_a_heartbeat(void **state)
{
    struct liveness liveness = ready_worker();

    run_until(&liveness, 9000, false, 0, 0);
    liveness_note_message(&liveness, 9000);
    assert_int_equal(run_until(&liveness, 19000, false, 0, 0), LIVENESS_ALIVE);
    assert_int_equal(run_until(&liveness, 20000, false, 0, 0), LIVENESS_SILENT);
}

static void idle_worker_needs_no_progress(void **state)
{
    struct liveness liveness = ready_worker();

    assert_int_equal(run_until(&liveness, 1000000, true, 0, 0), LIVENESS_ALIVE);
}

static void busy_worker_without_progress_is_stuck(void **state)
{
    struct liveness liveness = ready_worker();

    run_until(&liveness, 500000, true, 0, 0);
    liveness_set_busy(&liveness, true, 500000);
    assert_int_equal(run_until(&liveness, 620000, true, 0, 0), LIVENESS_ALIVE);
    assert_int_equal(run_until(&liveness, 621000, true, 0, 0), LIVENESS_STUCK);
    assert_string_equal(reason, "no progress for 120 s");
}

static void progress_keeps_a_busy_worker_alive(void **state)
{
    struct liveness liveness = ready_worker();

    liveness_set_busy(&liveness, true, 0);
    for (int i = 0; i < 10; i++) {
        assert_int_equal(run_until(&liveness, 100000 * (i + 1), true, 0, 0), LIVENESS_ALIVE);
        liveness_progress(&liveness, 100 + i, liveness.checked_ms);
    }
}

static void staying_busy_does_not_count_as_progress(void **state)
{
    struct liveness liveness = ready_worker();

    liveness_set_busy(&liveness, true, 0);
    run_until(&liveness, 100000, true, 0, 0);
    liveness_set_busy(&liveness, true, 100000);
    assert_int_equal(run_until(&liveness, 122000, true, 0, 0), LIVENESS_STUCK);
}

static int64_t slow_ms; // when it was told that the frame is slow; 0: never, -1: twice

// Simulates a worker whose progress grows while its frame does not end.
static enum liveness_verdict render_job_for(int64_t duration_ms, const struct liveness_job *job)
{
    struct liveness liveness = ready_worker();
    enum liveness_verdict verdict = LIVENESS_ALIVE;

    liveness_set_busy(&liveness, true, 0);
    liveness_begin_frame(&liveness, 0);
    slow_ms = 0;
    for (int64_t now_ms = 1000; now_ms <= duration_ms && verdict == LIVENESS_ALIVE; now_ms += 1000) {
        liveness_progress(&liveness, (double)now_ms, now_ms);
        verdict = liveness_check(&liveness, job, now_ms, reason);
        if (verdict == LIVENESS_SLOW) slow_ms = slow_ms ? -1 : now_ms;
        if (verdict == LIVENESS_SLOW) verdict = LIVENESS_ALIVE;
    }
    return verdict;
}

static enum liveness_verdict render_for(int64_t duration_ms, double median_s, size_t known)
{
    return render_job_for(duration_ms, &(struct liveness_job){.median_s = median_s, .known = known});
}

static void frame_may_take_twenty_medians(void **state)
{
    assert_int_equal(render_for(200000, 10, 5), LIVENESS_ALIVE);
    assert_int_equal(render_for(201000, 10, 5), LIVENESS_OVERLONG);
    assert_string_equal(reason, "frame renders for more than 200 s, the job's median is 10 s");
}

static void frame_may_always_take_a_minute(void **state)
{
    assert_int_equal(render_for(60000, 0.001, 63), LIVENESS_ALIVE);
    assert_int_equal(render_for(61000, 0.001, 63), LIVENESS_OVERLONG);
}

static void median_of_four_frames_limits_none(void **state)
{
    assert_int_equal(render_for(1000000, 0.001, 4), LIVENESS_ALIVE);
}

static void progress_without_end_ends_at_the_limit(void **state)
{
    struct liveness_job job = {.limit_ms = 3600 * 1000};

    assert_int_equal(render_job_for(3600 * 1000, &job), LIVENESS_ALIVE);
    assert_int_equal(render_job_for(3601 * 1000, &job), LIVENESS_OVER_LIMIT);
    assert_string_equal(reason, "frame takes more than 3600 s (frame-limit)");
    // What the job states replaces both the farm's limit and that by the median.
    job = (struct liveness_job){.limit_ms = 5000, .stated_limit_ms = 7000 * 1000, .median_s = 1, .known = 63};
    assert_int_equal(render_job_for(7000 * 1000, &job), LIVENESS_ALIVE);
    assert_int_equal(render_job_for(7001 * 1000, &job), LIVENESS_OVER_LIMIT);
    assert_string_equal(reason, "frame takes more than 7000 s (the job's frame_limit)");
}

static void slow_frame_is_told_once(void **state)
{
    assert_int_equal(render_for(150000, 10, 5), LIVENESS_ALIVE);
    assert_int_equal(slow_ms, 51000);
    assert_string_equal(reason, "frame takes more than 51 s, the job's median is 10 s");
    assert_int_equal(render_for(40000, 0.01, 5), LIVENESS_ALIVE);
    assert_int_equal(slow_ms, 11000);
    assert_int_equal(render_for(150000, 10, 4), LIVENESS_ALIVE);
    assert_int_equal(slow_ms, 0);
}

// Plans are for many frames: they have the farm's limit for themselves, and do not count as the frame's time.
static void plans_and_frames_have_limits_of_their_own(void **state)
{
    const struct liveness_job job = {.limit_ms = 100000, .stated_limit_ms = 10000};
    enum liveness_verdict verdict = LIVENESS_ALIVE;

    for (int planned = 0; planned <= 1; planned++) {
        struct liveness liveness = ready_worker();
        int64_t now_ms = 0;

        liveness_set_busy(&liveness, true, 0);
        liveness_begin_frame(&liveness, 0);
        verdict = LIVENESS_ALIVE;
        // 4 s of rendering, then plans of 30 s, or one without end.
        for (; verdict == LIVENESS_ALIVE; now_ms += 1000) {
            if (now_ms % 34000 == 4000) liveness_begin_plan(&liveness, now_ms);
            if (!planned && now_ms % 34000 == 0 && now_ms > 0) liveness_end_plan(&liveness, now_ms);
            liveness_progress(&liveness, (double)now_ms, now_ms);
            verdict = liveness_check(&liveness, &job, now_ms, reason);
        }
        assert_int_equal(verdict, LIVENESS_OVER_LIMIT);
        if (!planned) assert_string_equal(reason, "frame takes more than 10 s (the job's frame_limit)");
    }
    assert_string_equal(reason, "frame is planned for more than 100 s (frame-limit)");
}

static void ended_frame_has_no_run_time(void **state)
{
    struct liveness liveness = ready_worker();

    liveness_begin_frame(&liveness, 0);
    liveness_end_frame(&liveness, 1000);
    assert_int_equal(run_until(&liveness, 100000, true, 0.001, 63), LIVENESS_ALIVE);
}

static void an_idle_worker_has_no_run_time(void **state)
{
    struct liveness liveness = ready_worker();

    liveness_set_busy(&liveness, true, 0);
    liveness_begin_frame(&liveness, 0);
    liveness_set_busy(&liveness, false, 1000);
    run_until(&liveness, 100000, true, 0, 0);
    liveness_set_busy(&liveness, true, 100000);
    assert_int_equal(run_until(&liveness, 110000, true, 0.001, 63), LIVENESS_ALIVE);
}

static void a_late_check_does_not_count_against_the_worker(void **state)
{
    struct liveness liveness = ready_worker();

    assert_int_equal(liveness_check(&liveness, &(struct liveness_job){0}, 1000, reason), LIVENESS_ALIVE);
    assert_int_equal(liveness_check(&liveness, &(struct liveness_job){0}, 3600 * 1000, reason), LIVENESS_ALIVE);
    assert_int_equal(run_until(&liveness, 3600 * 1000 + 9000, false, 0, 0), LIVENESS_ALIVE);
    assert_int_equal(run_until(&liveness, 3600 * 1000 + 11000, false, 0, 0), LIVENESS_SILENT);
}

static void limits_can_be_set(void **state)
{
    struct liveness liveness = {.limits = {.heartbeat_ms = 3000}};

    liveness_start(&liveness, 0);
    liveness_ready(&liveness, 0);
    assert_int_equal(run_until(&liveness, 3000, false, 0, 0), LIVENESS_ALIVE);
    assert_int_equal(run_until(&liveness, 4000, false, 0, 0), LIVENESS_SILENT);
    assert_string_equal(reason, "no message for 3 s");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(worker_must_be_ready_within_thirty_seconds),
        cmocka_unit_test(silent_worker_is_found_after_ten_seconds),
        cmocka_unit_test(any_message_is_a_heartbeat),
        cmocka_unit_test(idle_worker_needs_no_progress),
        cmocka_unit_test(busy_worker_without_progress_is_stuck),
        cmocka_unit_test(progress_keeps_a_busy_worker_alive),
        cmocka_unit_test(staying_busy_does_not_count_as_progress),
        cmocka_unit_test(frame_may_take_twenty_medians),
        cmocka_unit_test(frame_may_always_take_a_minute),
        cmocka_unit_test(median_of_four_frames_limits_none),
        cmocka_unit_test(progress_without_end_ends_at_the_limit),
        cmocka_unit_test(slow_frame_is_told_once),
        cmocka_unit_test(plans_and_frames_have_limits_of_their_own),
        cmocka_unit_test(ended_frame_has_no_run_time),
        cmocka_unit_test(an_idle_worker_has_no_run_time),
        cmocka_unit_test(a_late_check_does_not_count_against_the_worker),
        cmocka_unit_test(limits_can_be_set),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
