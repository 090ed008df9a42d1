// SPDX-License-Identifier: Apache-2.0
#include "daemon/workers/worker_clock.h"

#include "core/base/alloc.h"
#include "core/base/log.h"
#include "daemon/farm/farm.h"
#include "daemon/settings/options.h"
#include "daemon/workers/worker_process.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { JOB = 7, FRAME = 5, KNOWN_S = 10 };

static struct {
    int count;
    enum log_level level;
    struct log_subject subject;
    char line[LOG_LINE_SIZE];
} heard;

static void hear(enum log_level level, const struct log_subject *subject, const char *line)
{
    heard.count++;
    heard.level = level;
    heard.subject = *subject;
    snprintf(heard.line, sizeof heard.line, "%s", line);
}

// Renders a frame of a job whose last frames took KNOWN_S, and beats, until the clock is checked at `until_ms`.
static void render_until(int64_t until_ms, int known)
{
    const struct options options = {.frame_limit_ms = 3600 * 1000};
    struct farm farm = {.options = &options};
    struct worker_process worker = {.id = 2};
    struct queue *queue = queue_create(3);
    struct frame_range range = {0};
    struct output_path path;
    struct job_record *record;

    heard.count = 0;
    log_set_sink(hear);
    assert_true(output_path_parse(&path, "a/c.##.exr", NULL));
    assert_true(frame_range_parse(&range, "1-20", NULL));
    record = job_table_add(&farm.jobs, JOB, xstrdup("/out"), &path);
    record->name = xstrdup("ash");
    record->queued = queue_add_job(queue, &(struct queue_job_params){.id = JOB, .frames = &range, .priority = 50});
    for (int i = 0; i < known; i++)
        estimate_add(&record->estimate, KNOWN_S);
    in_flight_add(&worker.in_flight, &(struct queue_ticket){.job = JOB, .frame = FRAME, .attempt = 1});
    liveness_start(&worker.liveness, 0);
    liveness_ready(&worker.liveness, 0);
    liveness_set_busy(&worker.liveness, true, 0);
    liveness_begin_frame(&worker.liveness, 0);
    for (int64_t now_ms = 0; now_ms <= until_ms; now_ms += 1000) {
        liveness_progress(&worker.liveness, (double)now_ms / 1e6, now_ms);
        worker_clock_check(&farm, &worker, now_ms);
    }
    log_set_sink(NULL);
    in_flight_finish(&worker.in_flight);
    job_table_finish(&farm.jobs);
    queue_destroy(queue);
}

static void a_frame_that_takes_five_medians_of_its_job_is_told_once(void **state)
{
    render_until(50 * 1000, 5);
    assert_int_equal(heard.count, 0);
    render_until(90 * 1000, 5);
    assert_int_equal(heard.count, 1);
    assert_int_equal(heard.level, LOG_WARN);
    assert_string_equal(heard.line, "job 7 frame 5: frame takes more than 51 s, the job's median is 10 s");
    assert_int_equal(heard.subject.job, JOB);
    assert_int_equal(heard.subject.worker, 2);
}

static void four_frames_of_a_job_say_too_little(void **state)
{
    render_until(90 * 1000, 4);
    assert_int_equal(heard.count, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_frame_that_takes_five_medians_of_its_job_is_told_once),
        cmocka_unit_test(four_frames_of_a_job_say_too_little),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
