// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_progress.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/ball_job.h"
#include "tests/support/gl_stage.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_make.h"
#include "worker/plan/plan_params.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// The share of the stages before the timing.
static const double TIMING_BEGINS = 1.0 / 2.5;

// The share of the light's stage above order 1, of a plan without timing.
static const double LIGHT_ENDS = 3.0 / 5.5;

struct told {
    double share;
    int falls, timings; // steps while frames are timed
    double lit, most;   // while light is measured: what was told last, and the longest step
    int ends;           // steps after the light
};

static bool on_progress(void *user, double done)
{
    struct told *told = user;

    told->falls += done < told->share;
    told->timings += done > told->share && done > TIMING_BEGINS + 1e-9;
    if (done <= LIGHT_ENDS + 1e-9) {
        told->most = fmax(told->most, done - told->share);
        told->lit = done;
    }
    told->ends += done > told->share && done > LIGHT_ENDS;
    told->share = done;
    return true;
}

static struct told make(bool is_timed, bool has_all_orders)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct error error = {{0}};
    struct told told = {0};
    enum renderer_fault fault;
    struct plan plan;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_S_1, BALL_JOB_POINT_LIGHT ", \"quality\": {\"tolerance\": 0.1}");
    frame_range_finish(&job.frames);
    assert_true(frame_range_parse(&job.frames, "0-7", NULL));
    if (has_all_orders) job.scene.orders = SCENE_ORDERS_ALL;
    if (!plan_make(&plan,
                   &(struct plan_params){.renderer = stage.renderer,
                                         .job = &job,
                                         .segment = plan_segment_at(&job, 0),
                                         .is_timed = is_timed,
                                         .on_progress = on_progress,
                                         .user = &told},
                   &fault, &error))
        fail_msg("%s", error.message);
    job_finish(&job);
    gl_stage_close(stage);
    return told;
}

static void timing_goes_on_with_the_share(void **state)
{
    struct told told = make(true, false);

    assert_int_equal(told.falls, 0);
    // Five frames, and the audit.
    assert_true(told.timings >= 6);
    assert_true(told.share > 0.85 && told.share <= 1.0);
}

static void a_plan_without_timing_is_done_before(void **state)
{
    struct told told = make(false, false);

    assert_int_equal(told.falls, 0);
    assert_true(told.share > TIMING_BEGINS);
}

// Most of such a plan's time is for the light that random paths tell.
static void light_of_all_orders_goes_on_evenly(void **state)
{
    struct told told = make(false, true);

    (void)state;
    assert_int_equal(told.falls, 0);
    assert_true(told.lit > 0.95 * LIGHT_ENDS && told.most < 0.1);
    assert_true(told.ends >= 3 && told.share > 0.8 && told.share <= 1.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(timing_goes_on_with_the_share),
        cmocka_unit_test(a_plan_without_timing_is_done_before),
        cmocka_unit_test(light_of_all_orders_goes_on_evenly),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
