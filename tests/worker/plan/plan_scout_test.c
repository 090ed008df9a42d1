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

// Fine structure from 0.5 to 0.9 s, between the pilot's frames at 0, 0.96 and 1.96 s.
static void frames_between_the_pilots_are_measured(void **state)
{
    static const char text[] =
        "{\"version\":1,\"name\":\"glow\",\"frames\":\"0-47\",\"fps\":24,\"resolution\":[320,180],"
        "\"camera\":{\"position\":[0,0.3,-3],\"target\":[0,0,0],\"fov\":45},\"scene\":{\"media\":[{\"sigma_a\":2,"
        "\"emission\":1,\"density\":{\"kind\":\"glsl\",\"source\":\"float density(vec3 p, float t) {"
        " float f = sin(9.0 * p.x) * sin(9.0 * p.y) * sin(9.0 * p.z);"
        " return t > 0.5 && t < 0.9 ? 8.0 * max(f, 0.0) : 1.0 + 0.1 * f; }\","
        "\"bounds\":{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1}}}]},"
        "\"output\":{\"path\":\"glow.####.exr\"},\"quality\":{\"tolerance\":0.01}}";
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct plan_segment segment;
    struct plan plan, within, beyond;
    double weight = 0.0;
    struct error error = {{0}};
    enum renderer_fault fault;
    struct job job;

    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    if (!plan_make(&plan,
                   &(struct plan_params){.renderer = stage.renderer, .job = &job, .segment = plan_segment_of(&job, 0)},
                   &fault, &error))
        fail_msg("%s", error.message);
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

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_over_the_tolerance_are_finer),
        cmocka_unit_test(other_frames_are_as_planned),
        cmocka_unit_test(frames_between_the_pilots_are_measured),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
