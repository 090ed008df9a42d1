// Linking counts as work: a plan links another family's program only where its frames may repay that.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/job/job.h"
#include "tests/support/example_job.h"
#include "tests/support/gl_stage.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_make.h"
#include "worker/plan/plan_params.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static int link_count;

static void count_links(enum log_level level, const struct log_subject *subject, const char *line)
{
    (void)level;
    (void)subject;
    link_count += strstr(line, " linked in ") != NULL;
}

// Plans the example of own code's first `frame_count` frames, and counts what that links.
static struct plan make_plan(int frame_count)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct error error = {{0}};
    enum renderer_fault fault;
    struct plan plan;
    struct job job;

    example_job_load(&job, "custom");
    job.width_px = 64;
    job.height_px = 36;
    job.quality = (struct job_quality){.method = JOB_METHOD_AUTO, .tolerance = 0.01, .samples = 1};
    job.frames.spans[0].count = frame_count;
    link_count = 0;
    log_set_level(LOG_DEBUG);
    log_set_sink(count_links);
    if (!plan_make(&plan,
                   &(struct plan_params){.renderer = stage.renderer, .job = &job, .segment = plan_segment_of(&job, 0)},
                   &fault, &error))
        fail_msg("%s", error.message);
    log_set_sink(NULL);
    log_set_level(LOG_INFO);
    print_message("%d frames: %d programs: %s\n", frame_count, link_count, plan.reason);
    job_finish(&job);
    gl_stage_close(stage);
    return plan;
}

static void one_small_frame_repays_no_other_family(void **state)
{
    struct plan of_one, of_many;
    int links_of_one;

    (void)state;
    of_one = make_plan(1);
    links_of_one = link_count;
    of_many = make_plan(48);
    assert_true(links_of_one < link_count);
    assert_non_null(strstr(of_one.reason, "no other method repays linking it"));
    assert_non_null(strstr(of_many.reason, "does the least work"));
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_small_frame_repays_no_other_family),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
