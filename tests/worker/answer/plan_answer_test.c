// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/plan_answer.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/json/json_write.h"
#include "tests/support/ball_job.h"
#include "tests/support/gl_stage.h"
#include "worker/answer/request.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

struct told {
    int64_t done;
    double share, most;
    int count;
};

static void on_part(void *user, int64_t done, int64_t count, double share)
{
    struct told *told = user;

    assert_int_equal(count, 2);
    assert_true(done == told->done ? told->count == 0 || share > told->share : done == told->done + 1 && share == 0.0);
    told->done = done;
    told->share = share;
    if (share > told->most) told->most = share;
    told->count++;
}

static void how_much_of_each_plan_is_made_is_told(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_AUTO, NULL);
    struct json_writer writer = {0};
    struct error error = {{0}};
    struct told told = {0};
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_S_1, BALL_JOB_POINT_LIGHT ", \"quality\": {\"tolerance\": 0.1}");
    frame_range_finish(&job.frames);
    assert_true(frame_range_parse(&job.frames, "0-49", NULL));
    if (!plan_answer_write(&job, &(struct request_tools){.renderer = stage.renderer, .on_part = on_part, .user = &told},
                           &writer, NULL, &error))
        fail_msg("%s", error.message);
    assert_int_equal(told.done, 1);
    assert_true(told.most > 0.5 && told.most <= 1.0);
    json_writer_finish(&writer);
    job_finish(&job);
    gl_stage_close(stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(how_much_of_each_plan_is_made_is_told)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
