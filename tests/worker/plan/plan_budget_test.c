// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_budget.h"

#include "core/job/job.h"
#include "tests/support/example_job.h"
#include "worker/plan/plan_family.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/plan_segment.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const double SECOND = 8e8; // evaluations

// Where rays pass the media, they have an optical depth of 1.
static double budget_of(const char *name, int width_px, int height_px, int64_t frame_count, double hit_share)
{
    static const float DEPTH = 1.0f;
    struct plan_params params;
    struct plan_scene scene;
    struct job job;
    double budget;

    example_job_load(&job, name);
    job.width_px = width_px;
    job.height_px = height_px;
    params = (struct plan_params){.job = &job, .segment = plan_segment_at(&job, 0)};
    plan_scene_init(&scene, &job);
    plan_scene_measure_lengths(&scene, params.segment.pilot, params.segment.pilot_count);
    params.segment.count = frame_count;
    if (hit_share > 0.0) {
        scene.depths = &DEPTH;
        scene.depth_count = 1;
        scene.hit_share = hit_share;
    }
    budget = plan_budget_find(&params, &scene);
    job_finish(&job);
    return budget;
}

static void little_work_has_a_second(void **state)
{
    (void)state;
    assert_true(budget_of("cloud", 64, 36, 48, 1.0) == SECOND);
    assert_true(budget_of("translucent", 64, 36, 1, 1.0) == SECOND);
}

static void dear_scenes_have_a_share_of_their_frames(void **state)
{
    double half = budget_of("translucent", 1920, 1080, 24, 1.0), whole = budget_of("translucent", 1920, 1080, 48, 1.0);

    (void)state;
    print_message("translucent: %.3g\n", whole);
    assert_true(half > SECOND);
    assert_true(whole > 1.9 * half && whole < 2.1 * half);
    assert_true(budget_of("translucent", 1920, 1080, 48, 0.1) < 0.2 * whole);
    assert_true(budget_of("translucent", 1920, 1080, 48, 0.0) == SECOND); // before any ray is known
    // A march towards lights from each step takes far more than the 50 evaluations of a pixel that misses the media.
    assert_true(whole > 0.05 * 48 * 1920 * 1080 * 200.0);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(little_work_has_a_second),
        cmocka_unit_test(dear_scenes_have_a_share_of_their_frames),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
