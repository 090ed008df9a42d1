// Scouting: tiny renders of frames that a plan was not made from, and finer plans for those over the tolerance.
// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_scout.h"

#include "core/base/error.h"
#include "core/job/job_json.h"
#include "tests/support/gl_stage.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_make.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/plan_scouting.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double TOLERANCE = 0.01;

static void frames_over_the_tolerance_are_finer(void **state)
{
    // Frames 48, 58, 68, 78, 88.
    const struct plan_scouting scouting = {
        .count = 5, .first = 48, .last = 88, .error = {0.002, 0.004, 0.03, 0.008, 0.002}};
    int most = plan_scouting_find_rungs(&scouting, 68, TOLERANCE);

    assert_int_equal(plan_scouting_find_rungs(&scouting, 48, TOLERANCE), 0);
    assert_int_equal(plan_scouting_find_rungs(&scouting, 78, TOLERANCE), 0);
    assert_int_equal(plan_scouting_find_rungs(&scouting, 88, TOLERANCE), 0);
    // Errors fall with the step to the power of 1.5: 0.03 falls to six tenths of the tolerance, and not to much less.
    assert_true(0.03 * exp2(-0.75 * most) <= 0.6 * TOLERANCE && 0.03 * exp2(-0.75 * most) > 0.3 * TOLERANCE);
    // Frames between scouts are interpolated.
    assert_true(plan_scouting_find_rungs(&scouting, 62, TOLERANCE) > 0);
    assert_true(plan_scouting_find_rungs(&scouting, 62, TOLERANCE) <= most);
    assert_true(plan_scouting_find_rungs(&scouting, 76, TOLERANCE) > 0);
}

static void other_frames_are_as_planned(void **state)
{
    const struct plan_scouting nothing = {0}, scouting = {.count = 3, .first = 10, .last = 12, .error = {1, 1, 1}};

    assert_int_equal(plan_scouting_find_rungs(&nothing, 0, TOLERANCE), 0);
    assert_int_equal(plan_scouting_find_rungs(&scouting, 9, TOLERANCE), 0);
    assert_int_equal(plan_scouting_find_rungs(&scouting, 13, TOLERANCE), 0);
    assert_true(plan_scouting_find_rungs(&scouting, 11, TOLERANCE) > 0);
}

// A ball of fine structure while `when` holds of the time t, for 48 frames. The pilot's are at 0, 0.96 and 1.96 s.
static struct job glow_job(const char *when)
{
    static const char format[] =
        "{\"version\":1,\"name\":\"glow\",\"frames\":\"0-47\",\"fps\":24,\"resolution\":[320,180],"
        "\"camera\":{\"position\":[0,0.3,-3],\"target\":[0,0,0],\"fov\":45},\"scene\":{\"media\":[{\"sigma_a\":2,"
        "\"emission\":1,\"density\":{\"kind\":\"glsl\",\"source\":\"float density(vec3 p, float t) {"
        " float f = sin(9.0 * p.x) * sin(9.0 * p.y) * sin(9.0 * p.z);"
        " return %s ? 8.0 * max(f, 0.0) : 1.0 + 0.1 * f; }\","
        "\"bounds\":{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1}}}]},"
        "\"output\":{\"path\":\"glow.####.exr\"},\"quality\":{\"tolerance\":0.01}}";
    struct error error = {{0}};
    char text[1024];
    struct job job;

    assert_in_range(snprintf(text, sizeof text, format, when), 1, sizeof text - 1);
    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    return job;
}

static struct plan make_plan(struct gl_stage stage, const struct job *job)
{
    struct error error = {{0}};
    enum renderer_fault fault;
    struct plan plan;

    if (!plan_make(&plan,
                   &(struct plan_params){.renderer = stage.renderer, .job = job, .segment = plan_segment_of(job, 0)},
                   &fault, &error))
        fail_msg("%s", error.message);
    return plan;
}

static void frames_between_the_pilots_are_measured(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct job job = glow_job("t > 0.5 && t < 0.9");
    struct plan plan = make_plan(stage, &job), within, beyond;
    struct plan_segment segment;
    double weight = 0.0;

    within = plan_of_frame(&plan, &job, 17);
    beyond = plan_of_frame(&plan, &job, 40);
    print_message("%s: step %g, of frame 17 %g, of frame 40 %g, %g of the work\n", plan.reason, plan.quality.step,
                  within.quality.step, beyond.quality.step, plan.work_ratio);
    assert_true(within.quality.step < 0.75 * plan.quality.step);
    assert_memory_equal(&beyond.quality, &plan.quality, sizeof plan.quality);
    // A fifth of the frames is refined.
    assert_true(plan.work_ratio > 1.05 && plan.work_ratio < 4.0);
    assert_true(plan.predicted_error <= TOLERANCE);
    segment = plan_segment_of(&job, 0);
    for (int frame = 0; frame < 48; frame++)
        weight += plan_frame_weight(&plan, &job, &segment, frame) / 48.0;
    assert_float_equal(weight, 1.0, 1e-9);
    assert_true(plan_frame_weight(&plan, &job, &segment, 17) > 1.2);
    assert_true(plan_frame_weight(&plan, &job, &segment, 40) < 0.9);
    job_finish(&job);
    gl_stage_close(stage);
}

static void a_plan_that_few_frames_could_have_is_finer(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct job few = glow_job("t > 0.5 && t < 0.9"), most = glow_job("abs(abs(t - 0.96) - 0.48) < 0.46");
    struct plan of_few = make_plan(stage, &few), of_most = make_plan(stage, &most), of_frame;

    of_frame = plan_of_frame(&of_most, &most, 17);
    print_message("step %g, where most frames need more %g, of frame 17 %g, %g of the work\n", of_few.quality.step,
                  of_most.quality.step, of_frame.quality.step, of_most.work_ratio);
    assert_true(of_most.quality.step < 0.75 * of_few.quality.step);
    assert_true(of_frame.quality.step > 0.75 * of_most.quality.step);
    assert_true(of_most.work_ratio < 1.5);
    assert_true(of_most.predicted_error <= TOLERANCE);
    job_finish(&few);
    job_finish(&most);
    gl_stage_close(stage);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_over_the_tolerance_are_finer),
        cmocka_unit_test(other_frames_are_as_planned),
        cmocka_unit_test(frames_between_the_pilots_are_measured),
        cmocka_unit_test(a_plan_that_few_frames_could_have_is_finer),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
