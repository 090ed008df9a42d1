// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_return.h"

#include "core/base/error.h"
#include "tests/support/ball_job.h"
#include "tests/support/example_job.h"
#include "tests/support/plan_keeper.h"
#include "tests/support/tolerance_stage.h"
#include "worker/picture/image.h"
#include "worker/plan/plan_family.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static struct tolerance_result draw(struct tolerance_stage stage, struct plan_keeper *keeper, const struct job *job,
                                    int32_t frame)
{
    const struct plan_source source = plan_keeper_source(keeper);
    struct image image = tolerance_stage_make_image(job);
    struct tolerance_result result;
    struct error error = {{0}};

    if (!tolerance_render(stage.tolerance,
                          &(struct tolerance_params){.job = job,
                                                     .serial = 1,
                                                     .frame = frame,
                                                     .image = &image,
                                                     .choice = PLAN_CHOICE_COARSEST,
                                                     .source = &source},
                          &result, &error))
        fail_msg("%s", error.message);
    image_finish(&image);
    return result;
}

// The coarsest settings miss in all frames here; then they are replaced by such that hold in all.
static void frames_return_to_settings_that_hold(void **state)
{
    struct tolerance_stage stage = tolerance_stage_open(NULL);
    struct plan_keeper keeper = {0};
    struct job job;
    struct tolerance_result result;

    (void)state;
    example_job_load(&job, "cloud");
    job.width_px = 32;
    job.height_px = 18;
    job.quality = (struct job_quality){
        .method = JOB_METHOD_AUTO, .tolerance = 0.02, .samples = 1, .max_depth = 8, .max_cut = 1.0};
    result = draw(stage, &keeper, &job, 3);
    assert_int_equal(result.retry_count, 1);
    assert_int_equal(keeper.number, 2);
    assert_true(keeper.plan.has_before);
    assert_true(keeper.plan.before.step > keeper.plan.quality.step);
    assert_true(keeper.first_sample_count > 0);
    assert_int_equal(keeper.plan.sample_count, keeper.first_sample_count); // of the settings before
    result = draw(stage, &keeper, &job, 5);
    assert_int_equal(result.retry_count, 0);
    result = draw(stage, &keeper, &job, 8); // tries them, and misses
    assert_int_equal(result.retry_count, 1);
    assert_true(result.first_error > 0.02 && result.audit.error <= 0.02);
    assert_int_equal(result.plan_number, 2);
    assert_int_equal(keeper.number, 2);

    keeper.plan.before = keeper.plan.view_quality; // that of the finest pictures of the pilot
    keeper.plan.sample_count = 0;
    keeper.number = 3;
    result = draw(stage, &keeper, &job, 25);
    assert_int_equal(result.plan_number, 3);
    assert_int_equal(keeper.number, 3);
    result = draw(stage, &keeper, &job, 24);
    assert_int_equal(result.retry_count, 0);
    assert_int_equal(result.plan_number, 3);
    assert_int_equal(keeper.number, 4);
    assert_int_equal(keeper.replaced, 3);
    assert_false(keeper.plan.has_before);
    result = draw(stage, &keeper, &job, 28);
    assert_int_equal(result.plan_number, 4);
    assert_int_equal(keeper.number, 4);
    job_finish(&job);
    tolerance_stage_close(stage);
}

// A plan that replaced settings of the first family that serves the job.
static struct plan replacing(const struct job *job)
{
    const struct plan_point point = {.rungs = {7, 3, 5, 2, 1}};
    struct plan_scene scene;
    size_t family = 0;

    plan_scene_init(&scene, job);
    while (!plan_family_serves(&plan_families[family], &scene))
        family++;
    return (struct plan){.has_before = true, .before = plan_family_quality(&plan_families[family], &scene, &point)};
}

static void frames_that_are_all_the_same_return_to_nothing(void **state)
{
    struct plan plan, before;
    struct job moving, still;

    (void)state;
    example_job_load(&moving, "cloud");
    moving.quality.method = JOB_METHOD_AUTO;
    plan = replacing(&moving);
    assert_true(plan_return_find(&plan, &moving, 4, &before));
    assert_false(plan_return_find(&plan, &moving, 5, &before));
    ball_job_parse(&still, BALL_JOB_SIGMA_S_1, BALL_JOB_POINT_LIGHT ", \"quality\": {\"tolerance\": 0.01}");
    assert_true(scene_is_constant(&still.scene));
    plan = replacing(&still);
    assert_false(plan_return_find(&plan, &still, 0, &before));
    job_finish(&still);
    job_finish(&moving);
}

static void what_is_near_the_tolerance_is_not_kept(void **state)
{
    struct audit_result audit = {.error = 0.014, .spread = 0.0015, .tolerance = 0.02};

    (void)state;
    assert_true(plan_return_holds(&audit));
    audit.spread = 0.003;
    assert_false(plan_return_holds(&audit));
}

// A plan that replaces another one's replacement returns to the first.
static void the_first_settings_stay_the_ones_before(void **state)
{
    struct plan first = {.quality = {.step = 4.0}, .pixels = {16, 0.5}}, second = {.quality = {.step = 2.0}},
                third = {.quality = {.step = 1.0}};

    (void)state;
    plan_return_note(&second, &first);
    plan_return_note(&third, &second);
    assert_true(third.has_before && third.before.step == 4.0 && third.before.pixels.stride == 16);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_return_to_settings_that_hold),
        cmocka_unit_test(frames_that_are_all_the_same_return_to_nothing),
        cmocka_unit_test(what_is_near_the_tolerance_is_not_kept),
        cmocka_unit_test(the_first_settings_stay_the_ones_before),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
