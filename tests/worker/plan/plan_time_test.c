// What a frame is foretold to take, where to render it would take too long to ask.
// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_time.h"

#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/job/job_json.h"
#include "tests/support/gl_stage.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_evidence.h"
#include "worker/plan/plan_overhead.h"
#include "worker/plan/plan_params.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static const char JOB[] =
    "{\"version\":1,\"name\":\"long\",\"frames\":\"0\",\"fps\":24,\"resolution\":[320,180],"
    "\"camera\":{\"position\":[0,0,4],\"target\":[0,0,0],\"fov\":40},"
    "\"lights\":[{\"kind\":\"point\",\"position\":[2,2.5,1.5],\"intensity\":20}],"
    "\"scene\":{\"scattering\":{\"orders\":\"all\"},\"media\":[{\"density\":{\"kind\":\"homogeneous\",\"bounds\":"
    "{\"kind\":\"sphere\",\"radius\":1}},\"sigma_s\":2,\"sigma_a\":0.1}]},"
    "\"quality\":{\"tolerance\":0.1},\"output\":{\"path\":\"long.####.exr\"}}";

// A million paths of each pixel would take hours.
static void long_frames_are_foretold_without_them(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct plan plan = {.quality = {.method = JOB_METHOD_PATHS, .samples = 1, .paths = 1 << 20, .max_cut = 1.0},
                        .predicted_s = 1e4,
                        .predicted_processor_s = 2e4,
                        .work_ratio = 1.0};
    const struct plan_evidence evidence = {0};
    enum renderer_fault fault = RENDERER_FAULT_NONE;
    double began_s = clock_now_s();
    struct plan_params params = {.renderer = stage.renderer};
    struct error error = {{0}};
    struct job job;

    (void)state;
    if (!job_parse(&job, JOB, strlen(JOB), NULL, &error)) fail_msg("%s", error.message);
    params.job = &job;
    params.segment = plan_segment_of(&job, 0);
    if (!plan_time_predict(&plan, &params, &fault, &error) ||
        !plan_overhead_predict(&plan, &params, &evidence, &fault, &error))
        fail_msg("%s", error.message);
    print_message("foretold in %.2f s: %.3g s, audit %.3g s, file %.3g s\n", clock_now_s() - began_s, plan.predicted_s,
                  plan.predicted_audit_s, plan.predicted_encode_s);
    assert_true(plan.predicted_s == 1e4 && plan.predicted_processor_s == 2e4);
    assert_true(plan.predicted_audit_s > 0.0 && plan.predicted_encode_s > 0.0);
    assert_true(plan.predicted_frame_s > 1e4);
    job_finish(&job);
    gl_stage_close(stage);
}

// What takes a moment is measured.
static void short_frames_are_timed(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct plan plan = {.quality = {.method = JOB_METHOD_PATHS, .samples = 1, .paths = 1, .max_cut = 1.0},
                        .predicted_s = 1.0,
                        .work_ratio = 1.0};
    enum renderer_fault fault = RENDERER_FAULT_NONE;
    struct plan_params params = {.renderer = stage.renderer};
    struct error error = {{0}};
    struct job job;

    (void)state;
    if (!job_parse(&job, JOB, strlen(JOB), NULL, &error)) fail_msg("%s", error.message);
    params.job = &job;
    params.segment = plan_segment_of(&job, 0);
    if (!plan_time_predict(&plan, &params, &fault, &error)) fail_msg("%s", error.message);
    assert_true(plan.predicted_s > 0.0 && plan.predicted_s != 1.0 && plan.predicted_processor_s > 0.0);
    job_finish(&job);
    gl_stage_close(stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(long_frames_are_foretold_without_them),
        cmocka_unit_test(short_frames_are_timed),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
