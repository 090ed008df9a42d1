// What sparse pixels add to a picture's error follows from their threshold, and so does the share that is traced.
// SPDX-License-Identifier: Apache-2.0
#include "core/job/job.h"
#include "tests/support/example_job.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "tests/support/sparse_pair.h"
#include "worker/render/renderer.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { THRESHOLDS = 3 };
static const double thresholds[THRESHOLDS] = {0.003, 0.01, 0.03};
static const double SHARE = 0.3; // of the threshold, which the error stays below

struct variant {
    const char *job;
    double time;
    struct job_quality quality;
};

#define PATHS .samples = 1, .max_depth = 8, .min_throughput = 0.001, .max_cut = 1.0

static const struct variant variants[] = {
    {"cloud", 5, {.method = JOB_METHOD_CACHED, .step = 0.01, .light_grid = 64, .samples = 1}},
    {"noise", 1, {.method = JOB_METHOD_CACHED, .step = 0.04, .light_grid = 64, .samples = 1}},
    {"scan", 1, {.method = JOB_METHOD_MIDPOINT, .step_voxels = 1, .samples = 1}},
    {"fog", 1, {.method = JOB_METHOD_EQUIANGULAR, .points = 8, .samples = 1}},
    {"sunset", 7, {.method = JOB_METHOD_EQUIANGULAR, .points = 8, .samples = 1}},
    {"custom", 1, {.method = JOB_METHOD_MIDPOINT, .step = 0.02, .light_step = 0.1, .samples = 1}},
    {"glass", 2, {.method = JOB_METHOD_EQUIANGULAR, .points = 1, PATHS}},
};

static int check(struct renderer *renderer, const struct variant *variant)
{
    double traced = 1.0;
    struct job job;
    int broken = 0;

    example_job_load(&job, variant->job);
    example_job_shrink(&job, 320, 180, variant->time);
    job.quality = variant->quality;
    for (int i = 0; i < THRESHOLDS; i++) {
        struct sparse_pair pair;
        double error;
        bool ok;

        sparse_pair_render(renderer, &job, 0, (struct job_pixels){16, thresholds[i]}, &pair);
        error = sparse_pair_error(&pair);
        ok = error <= SHARE * thresholds[i] && pair.sparse_result.traced <= traced;
        traced = pair.sparse_result.traced;
        print_message("%s at %g: %.1f %% traced, error %.2e%s\n", variant->job, thresholds[i], 100 * traced, error,
                      ok ? "" : ": too much");
        broken += !ok;
        sparse_pair_finish(&pair);
    }
    job_finish(&job);
    return broken;
}

static void the_error_follows_from_the_threshold(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    int broken = 0;

    (void)state;
    for (size_t i = 0; i < sizeof variants / sizeof *variants; i++)
        broken += check(stage.renderer, &variants[i]);
    assert_int_equal(broken, 0);
    gl_stage_close(stage);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_error_follows_from_the_threshold)};

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
