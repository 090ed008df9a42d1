// What a frame is foretold to take, where to render it would take too long to ask.
// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_time.h"

#include "core/base/error.h"
#include "core/job/job_json.h"
#include "tests/support/gl_stage.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_evidence.h"
#include "worker/plan/plan_overhead.h"
#include "worker/plan/plan_params.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
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

enum { CALLS = 500 }; // of progress, within which all is foretold

struct timed {
    struct gl_stage stage;
    struct plan_params params;
    struct job job;
    int calls;
};

static bool on_progress(void *user, double done)
{
    struct timed *timed = user;

    (void)done;
    return ++timed->calls < CALLS;
}

static void open_timed(struct timed *timed)
{
    struct error error = {{0}};

    *timed = (struct timed){.stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL)};
    if (!job_parse(&timed->job, JOB, strlen(JOB), NULL, &error)) fail_msg("%s", error.message);
    timed->params = (struct plan_params){.renderer = timed->stage.renderer,
                                         .job = &timed->job,
                                         .segment = plan_segment_of(&timed->job, 0),
                                         .on_progress = on_progress,
                                         .user = timed};
}

static void close_timed(struct timed *timed)
{
    job_finish(&timed->job);
    gl_stage_close(timed->stage);
}

static struct plan plan_of(int paths, double predicted_s)
{
    return (struct plan){.quality = {.method = JOB_METHOD_PATHS, .samples = 1, .paths = paths, .max_cut = 1.0},
                         .predicted_s = predicted_s,
                         .predicted_processor_s = 2.0 * predicted_s,
                         .work_ratio = 1.0};
}

// A million paths of each pixel would take hours.
static void long_frames_are_foretold_without_them(void **state)
{
    struct plan plan = plan_of(1 << 20, 1e4);
    const struct plan_evidence evidence = {0};
    enum renderer_fault fault = RENDERER_FAULT_NONE;
    struct error error = {{0}};
    struct timed timed;

    (void)state;
    open_timed(&timed);
    if (!plan_time_predict(&plan, &timed.params, &fault, &error) ||
        !plan_overhead_predict(&plan, &timed.params, &evidence, &fault, &error))
        fail_msg("%s", error.message);
    print_message("%d calls of progress\n", timed.calls);
    assert_true(plan.predicted_s == 1e4 && plan.predicted_processor_s == 2e4);
    assert_true(plan.predicted_audit_s > 0.0 && plan.predicted_encode_s > 0.0);
    assert_true(plan.predicted_frame_s > 1e4);
    close_timed(&timed);
}

// What takes a moment is measured.
static void short_frames_are_timed(void **state)
{
    struct plan plan = plan_of(1, 1.0);
    enum renderer_fault fault = RENDERER_FAULT_NONE;
    struct error error = {{0}};
    struct timed timed;

    (void)state;
    open_timed(&timed);
    if (!plan_time_predict(&plan, &timed.params, &fault, &error)) fail_msg("%s", error.message);
    assert_true(plan.predicted_s > 0.0 && plan.predicted_s != 1.0 && plan.predicted_processor_s > 0.0);
    close_timed(&timed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(long_frames_are_foretold_without_them),
        cmocka_unit_test(short_frames_are_timed),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
