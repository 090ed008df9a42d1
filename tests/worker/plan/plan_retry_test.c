// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_retry.h"

#include "core/job/job.h"
#include "tests/support/example_job.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 320, HEIGHT_PX = 180 };

// A frame of the cloud over its tolerance, its left half being clear, and the plan by which it was rendered.
struct stage {
    struct job job;
    struct image image;
    struct plan plan;
    struct plan_retry retry;
};

static size_t find_family(enum job_method method)
{
    size_t i = 0;

    while (plan_families[i].method != method)
        i++;
    return i;
}

static void open_ordered(struct stage *stage, enum job_method method, struct plan_point point, int orders)
{
    struct plan_scene scene;

    memset(stage, 0, sizeof *stage);
    example_job_load(&stage->job, "cloud");
    stage->job.scene.orders = orders;
    stage->job.width_px = WIDTH_PX;
    stage->job.height_px = HEIGHT_PX;
    stage->job.quality = (struct job_quality){.method = JOB_METHOD_AUTO, .tolerance = 0.01, .samples = 1};
    assert_true(image_init(&stage->image, WIDTH_PX, HEIGHT_PX, false, false, NULL));
    for (int i = 0; i < WIDTH_PX * HEIGHT_PX; i++)
        stage->image.rgba[4 * i + 3] = i % WIDTH_PX < WIDTH_PX / 2 ? 0.0f : 0.5f;
    plan_scene_init(&scene, &stage->job);
    stage->plan = (struct plan){.family = find_family(method), .point = point};
    stage->plan.quality = plan_family_quality(&plan_families[stage->plan.family], &scene, &point);
    plan_retry_init(&stage->retry, &stage->job, &stage->image, &stage->plan);
}

static void open_stage(struct stage *stage, enum job_method method, struct plan_point point)
{
    open_ordered(stage, method, point, 1);
}

static void open_scattered(struct stage *stage, struct plan_point point)
{
    open_ordered(stage, JOB_METHOD_MIDPOINT, point, 3);
}

static void close_stage(struct stage *stage)
{
    image_finish(&stage->image);
    job_finish(&stage->job);
}

static double work_of(const struct stage *stage, const struct plan *plan)
{
    return plan_family_work(&stage->retry.scene, &plan->quality);
}

static void the_frame_itself_says_how_deep_its_rays_are(void **state)
{
    struct stage stage;

    open_stage(&stage, JOB_METHOD_MIDPOINT, (struct plan_point){.rungs = {4, 4, 3}});
    assert_float_equal(stage.retry.scene.hit_share, 0.5, 0.05);
    for (size_t i = 0; i < stage.retry.scene.depth_count; i++)
        assert_float_equal(stage.retry.scene.depths[i], log(2.0), 1e-6);
    assert_float_equal(stage.retry.first_work, work_of(&stage, &stage.plan), 1e-9);
    close_stage(&stage);
}

static void only_what_is_to_blame_is_refined(void **state)
{
    for (int blamed = 0; blamed < 3; blamed++) {
        double changes[PLAN_AXIS_LIMIT] = {0.0};
        struct stage stage;
        struct plan plan;

        open_stage(&stage, JOB_METHOD_MIDPOINT, (struct plan_point){.rungs = {4, 4, 3}});
        plan = stage.plan;
        changes[blamed] = 0.3;
        assert_true(plan_retry_refine(&stage.retry, &plan, changes, 0.012));
        // From 0.012 to half of 0.01: two rungs divide by 2^1.5.
        for (int axis = 0; axis < 3; axis++)
            assert_int_equal(plan.point.rungs[axis] - stage.plan.point.rungs[axis], axis == blamed ? 2 : 0);
        close_stage(&stage);
    }
}

// Two rungs double the steps towards lights; where these are the coarsest, those along camera rays.
static void loops_that_are_cut_become_shorter(void **state)
{
    struct stage stage;
    struct plan plan;

    (void)state;
    open_stage(&stage, JOB_METHOD_MIDPOINT, (struct plan_point){.rungs = {3, 4, 3}});
    plan = stage.plan;
    assert_true(plan_retry_shorten(&stage.retry, &plan, 2));
    assert_float_equal(plan.quality.light_step, 2.0 * stage.plan.quality.light_step, 1e-9);
    assert_true(plan.quality.step == stage.plan.quality.step);
    assert_true(plan_retry_shorten(&stage.retry, &plan, 5) && plan_retry_shorten(&stage.retry, &plan, 1));
    assert_int_equal(plan.point.rungs[0], 2);
    assert_int_equal(plan.point.rungs[1], 0);
    assert_int_equal(plan.point.rungs[2], 3);
    assert_true(plan_retry_shorten(&stage.retry, &plan, 2));
    assert_false(plan_retry_shorten(&stage.retry, &plan, 1));
    close_stage(&stage);
}

static void nothing_is_refined_where_the_finest_is_to_blame(void **state)
{
    double changes[PLAN_AXIS_LIMIT] = {0.0, 0.0, 0.3};
    struct stage stage;
    struct plan plan;

    open_stage(&stage, JOB_METHOD_MIDPOINT, (struct plan_point){.rungs = {4, 4, 8}});
    plan = stage.plan;
    assert_true(plan.quality.min_transmittance == 0.0);
    assert_false(plan_retry_refine(&stage.retry, &plan, changes, 0.012));
    assert_memory_equal(&plan.point, &stage.plan.point, sizeof plan.point);
    close_stage(&stage);
}

static void all_axes_are_refined_where_none_is_known_to_blame(void **state)
{
    double unknown[PLAN_AXIS_LIMIT] = {0.0};
    struct stage stage;
    struct plan plan;

    open_stage(&stage, JOB_METHOD_MIDPOINT, (struct plan_point){.rungs = {4, 4, 3}});
    plan = stage.plan;
    assert_true(plan_retry_refine(&stage.retry, &plan, unknown, 0.008));
    for (int axis = 0; axis < 3; axis++)
        assert_true(plan.point.rungs[axis] > stage.plan.point.rungs[axis]);
    close_stage(&stage);
}

static void all_renderings_together_stay_within_the_limit(void **state)
{
    static const double errors[] = {0.011, 0.03, 0.5, INFINITY, NAN};
    static const enum job_method methods[] = {JOB_METHOD_MIDPOINT, JOB_METHOD_CACHED, JOB_METHOD_GAUSS};

    for (size_t i = 0; i < sizeof errors / sizeof errors[0]; i++)
        for (size_t k = 0; k < sizeof methods / sizeof methods[0]; k++) {
            struct stage stage;
            double changes[PLAN_AXIS_LIMIT] = {0.2, 0.1, 0.01}, work = 0.0;
            struct plan plan;

            open_stage(&stage, methods[k], (struct plan_point){.rungs = {6, 5, 3}});
            plan = stage.plan;
            for (; stage.retry.count < PLAN_RETRY_LIMIT; stage.retry.count++) {
                if (!plan_retry_refine(&stage.retry, &plan, changes, errors[i])) break;
                work += work_of(&stage, &plan);
                plan_retry_spend(&stage.retry, &plan, WIDTH_PX, HEIGHT_PX);
            }
            assert_true(stage.retry.count >= 1);
            assert_true(work <= PLAN_RETRY_WORK * stage.retry.unit_work);
            close_stage(&stage);
        }
}

// A light grid of a small picture takes most of its work, and eight times that refines it by no more than a halving.
static void little_work_is_no_limit(void **state)
{
    double changes[PLAN_AXIS_LIMIT] = {0.0, 0.3};
    struct stage stage;
    struct plan plan;

    open_stage(&stage, JOB_METHOD_CACHED, (struct plan_point){.rungs = {2, 0, 1}});
    plan = stage.plan;
    assert_true(stage.retry.unit_work > 2.0 * stage.retry.first_work);
    assert_float_equal(stage.retry.unit_work * WIDTH_PX * HEIGHT_PX, PLAN_RETRY_LEAST, 1.0);
    assert_true(plan_retry_refine(&stage.retry, &plan, changes, 0.042));
    assert_true(changes[1] <= 0.01);
    close_stage(&stage);
}

static void more_work_is_a_limit_to_itself(void **state)
{
    struct stage stage;

    open_stage(&stage, JOB_METHOD_MIDPOINT, (struct plan_point){.rungs = {12, 12, 3}});
    assert_true(stage.retry.unit_work == stage.retry.first_work);
    close_stage(&stage);
}

static void small_pictures_cost_little(void **state)
{
    struct stage stage;

    open_stage(&stage, JOB_METHOD_MIDPOINT, (struct plan_point){.rungs = {4, 4, 3}});
    plan_retry_spend(&stage.retry, &stage.plan, WIDTH_PX / 4, HEIGHT_PX / 4);
    assert_float_equal(stage.retry.spent_work, stage.retry.first_work / 16.0, 1e-3 * stage.retry.first_work);
    close_stage(&stage);
}

static void an_axis_is_varied_towards_less_work(void **state)
{
    struct stage stage;
    struct plan plan;

    open_stage(&stage, JOB_METHOD_MIDPOINT, (struct plan_point){.rungs = {4, 1, 3}});
    plan = stage.plan;
    plan_retry_vary(&stage.retry, &plan, 0);
    assert_int_equal(plan.point.rungs[0], 4 - PLAN_HALVING_RUNGS);
    assert_true(plan.quality.step == 2.0 * stage.plan.quality.step);
    plan = stage.plan;
    plan_retry_vary(&stage.retry, &plan, 1);
    assert_int_equal(plan.point.rungs[1], 1 + PLAN_HALVING_RUNGS);
    close_stage(&stage);
}

static void the_next_family_is_as_fine_where_that_is_allowed(void **state)
{
    struct stage stage;
    struct plan plan;

    open_stage(&stage, JOB_METHOD_GAUSS, (struct plan_point){.rungs = {6, 6, 3}});
    plan = stage.plan;
    assert_true(plan_retry_change_family(&stage.retry, &plan));
    assert_int_equal(plan.quality.method, JOB_METHOD_ADAPTIVE);
    assert_true(plan.quality.step > 0.0 && plan.quality.light_step > 0.0 && plan.quality.depth_step > 0.0);
    assert_true(work_of(&stage, &plan) <= plan_retry_allowance(&stage.retry));
    // From the last family on, the search goes on with the first.
    plan = stage.plan;
    plan.family = find_family(JOB_METHOD_MIDPOINT);
    assert_true(plan_retry_change_family(&stage.retry, &plan));
    assert_int_not_equal(plan.quality.method, JOB_METHOD_MIDPOINT);
    stage.retry.spent_work = PLAN_RETRY_WORK * stage.retry.unit_work;
    assert_false(plan_retry_change_family(&stage.retry, &plan));
    close_stage(&stage);
}

// A picture by the same settings would be the same picture.
static void no_family_is_tried_twice(void **state)
{
    struct stage stage;
    bool tried[64] = {false};
    int count = 0;

    (void)state;
    open_stage(&stage, JOB_METHOD_GAUSS, (struct plan_point){.rungs = {6, 6, 3}});
    tried[stage.plan.family] = true;
    for (struct plan plan = stage.plan; plan_retry_change_family(&stage.retry, &plan); plan = stage.plan) {
        assert_false(tried[plan.family]);
        tried[plan.family] = true;
        assert_true(++count < 64);
    }
    assert_true(count >= 2);
    close_stage(&stage);
}

static void later_frames_are_no_finer_than_needed(void **state)
{
    struct stage stage;
    struct plan missed, found;

    (void)state;
    open_stage(&stage, JOB_METHOD_MIDPOINT, (struct plan_point){.rungs = {4, 4, 3}});
    missed = stage.plan;
    found = stage.plan;
    found.point = (struct plan_point){.rungs = {10, 7, 3}};
    // From 0.052 over 0.0065 to 0.0008125: half of the way, rounded up.
    plan_retry_settle(&stage.retry, &missed, 0.052, &found, 0.0008125);
    assert_memory_equal(&found.point, (&(struct plan_point){.rungs = {7, 6, 3}}), sizeof found.point);
    assert_true(found.quality.step == stage.plan.quality.step * exp2(-1.5));
    close_stage(&stage);
}

static void a_plan_that_is_as_fine_as_needed_stays(void **state)
{
    static const double errors[][2] = {{0.052, 0.008}, {INFINITY, 0.001}, {0.006, 0.001}};
    struct stage stage;
    struct plan other;

    (void)state;
    open_stage(&stage, JOB_METHOD_MIDPOINT, (struct plan_point){.rungs = {4, 4, 3}});
    for (size_t i = 0; i < sizeof errors / sizeof errors[0]; i++) {
        struct plan found = stage.plan;

        found.point = (struct plan_point){.rungs = {10, 7, 3}};
        plan_retry_settle(&stage.retry, &stage.plan, errors[i][0], &found, errors[i][1]);
        assert_int_equal(found.point.rungs[0], 10);
    }
    other = stage.plan;
    other.family = find_family(JOB_METHOD_GAUSS);
    other.point = (struct plan_point){.rungs = {10, 7, 3}};
    plan_retry_settle(&stage.retry, &stage.plan, 0.052, &other, 0.001);
    assert_int_equal(other.point.rungs[0], 10);
    close_stage(&stage);
}

// A plan of scattered light knows what its cells and its paths add: no picture has to tell. Few paths are refined
// first, and no further than needed, since work grows with the fourth power of what is asked.
static void a_plan_of_scattered_light_knows_what_is_to_blame(void **state)
{
    enum { STEP, LIGHT, OPACITY, CELLS, PATHS };
    double changes[PLAN_AXIS_LIMIT] = {7.0};
    struct stage stage;
    struct plan plan;

    (void)state;
    open_stage(&stage, JOB_METHOD_CACHED, (struct plan_point){.rungs = {6, 5, 3}});
    assert_false(plan_retry_know(&stage.retry, &stage.plan, changes));
    close_stage(&stage);
    open_scattered(&stage, (struct plan_point){.rungs = {6, 5, 3, 7, 21}});
    plan = stage.plan;
    plan.cells_square = 1e-5;
    plan.paths_square = 9e-5;
    assert_true(plan_retry_know(&stage.retry, &plan, changes));
    assert_true(changes[STEP] == 0.0 && changes[LIGHT] == 0.0 && changes[OPACITY] == 0.0);
    assert_float_equal(changes[CELLS], sqrt(2.5e-5), 1e-9); // a fourth at least
    assert_float_equal(changes[PATHS], sqrt(9e-5), 1e-9);
    assert_true(plan_retry_refine(&stage.retry, &plan, changes, 0.0088));
    assert_int_equal(plan.point.rungs[CELLS], 7);
    assert_int_equal(plan.point.rungs[PATHS], 22); // one rung leaves 0.0077, which is below 0.8 of the tolerance
    close_stage(&stage);
}

// How noise falls is sure: what is left after many more paths are traced is no noise, whatever the plan believed.
static void what_more_paths_leave_is_blamed_on_cells(void **state)
{
    enum { CELLS = 3, PATHS };
    double changes[PLAN_AXIS_LIMIT];
    struct stage stage;
    struct plan plan;
    int paths;

    (void)state;
    open_scattered(&stage, (struct plan_point){.rungs = {6, 5, 3, 4, 8}});
    plan = stage.plan;
    plan.cells_square = 1e-6;
    plan.paths_square = 9e-5;
    assert_true(plan_retry_know(&stage.retry, &plan, changes));
    assert_true(plan_retry_refine(&stage.retry, &plan, changes, 0.016));
    paths = plan.point.rungs[PATHS];
    assert_true(paths >= 8 + 4 && plan.point.rungs[CELLS] <= 5);
    stage.retry.count++;
    plan.point.rungs[CELLS] = 4; // as if no cell had been made finer
    assert_true(plan_retry_refine(&stage.retry, &plan, changes, 0.014));
    assert_int_equal(plan.point.rungs[PATHS], paths);
    assert_true(plan.point.rungs[CELLS] >= 5);
    close_stage(&stage);
}

// Eight times as many paths leave a third of the noise. Three times the tolerance is worth a try, eight times is not.
static void paths_that_cannot_do_are_not_traced(void **state)
{
    struct stage stage;
    struct plan plan;

    (void)state;
    open_ordered(&stage, JOB_METHOD_PATHS, (struct plan_point){.rungs = {20}}, 3);
    for (int publishes = 0; publishes < 2; publishes++) {
        double mild[PLAN_AXIS_LIMIT] = {0.03}, hopeless[PLAN_AXIS_LIMIT] = {0.08}, unknown[PLAN_AXIS_LIMIT] = {0.0};

        stage.job.quality.on_miss = publishes ? JOB_ON_MISS_PUBLISH : JOB_ON_MISS_FAIL;
        plan = stage.plan;
        assert_true(plan_retry_refine(&stage.retry, &plan, mild, 0.03));
        plan = stage.plan;
        assert_int_equal(plan_retry_refine(&stage.retry, &plan, hopeless, 0.08), publishes);
        assert_true(publishes == (plan.point.rungs[0] > stage.plan.point.rungs[0]));
        plan = stage.plan;
        assert_true(plan_retry_refine(&stage.retry, &plan, unknown, INFINITY)); // nothing is known of it
    }
    close_stage(&stage);
}

static void later_frames_of_scattered_light_stay_near_the_tolerance(void **state)
{
    struct stage stage;
    struct plan missed, found;

    (void)state;
    open_scattered(&stage, (struct plan_point){.rungs = {6, 5, 3, 7, 21}});
    missed = found = stage.plan;
    found.point.rungs[4] = 25;
    plan_retry_settle(&stage.retry, &missed, 0.0101, &found, 0.0071);
    // From 0.0101 to 0.0071 by 4 rungs: 0.0085, which is asked for, lies half of the way. Of others, 0.0065 is.
    assert_int_equal(found.point.rungs[4], 23);
    close_stage(&stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_frame_itself_says_how_deep_its_rays_are),
        cmocka_unit_test(only_what_is_to_blame_is_refined),
        cmocka_unit_test(loops_that_are_cut_become_shorter),
        cmocka_unit_test(nothing_is_refined_where_the_finest_is_to_blame),
        cmocka_unit_test(all_axes_are_refined_where_none_is_known_to_blame),
        cmocka_unit_test(all_renderings_together_stay_within_the_limit),
        cmocka_unit_test(little_work_is_no_limit),
        cmocka_unit_test(more_work_is_a_limit_to_itself),
        cmocka_unit_test(small_pictures_cost_little),
        cmocka_unit_test(an_axis_is_varied_towards_less_work),
        cmocka_unit_test(the_next_family_is_as_fine_where_that_is_allowed),
        cmocka_unit_test(no_family_is_tried_twice),
        cmocka_unit_test(later_frames_are_no_finer_than_needed),
        cmocka_unit_test(a_plan_that_is_as_fine_as_needed_stays),
        cmocka_unit_test(a_plan_of_scattered_light_knows_what_is_to_blame),
        cmocka_unit_test(what_more_paths_leave_is_blamed_on_cells),
        cmocka_unit_test(paths_that_cannot_do_are_not_traced),
        cmocka_unit_test(later_frames_of_scattered_light_stay_near_the_tolerance),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
