// The walk to the setting with the least work, on known errors; and the segments of a job.
// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_search.h"

#include "core/job/job.h"
#include "worker/plan/plan_segment.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

// Two axes of steps whose squared errors add, weighted. A step along either costs the same work.
struct terrain {
    double shares[2];
    int cannot_from; // the first axis' rung from which points cannot be measured; 0: none
    int stop_after;  // measurements; 0: never
    int measured;
};

static double work(void *user, const struct plan_point *point)
{
    return exp2(0.5 * point->rungs[0]) * (1.0 + exp2(0.5 * point->rungs[1]));
}

static double error_of(const struct terrain *terrain, const struct plan_point *point)
{
    return hypot(terrain->shares[0] * exp2(-point->rungs[0]), terrain->shares[1] * exp2(-point->rungs[1]));
}

static enum plan_measured measure(void *user, const struct plan_point *point, double *error)
{
    struct terrain *terrain = user;

    if (++terrain->measured == terrain->stop_after) return PLAN_STOPPED;
    if (terrain->cannot_from > 0 && point->rungs[0] >= terrain->cannot_from) return PLAN_CANNOT;
    *error = error_of(terrain, point);
    return PLAN_MEASURED;
}

static struct plan_finding search(struct terrain *terrain, struct plan_point start, double work_limit)
{
    return plan_search_run(&(struct plan_search){.axis_count = 2,
                                                 .last_rung = {20, 20},
                                                 .start = start,
                                                 .target = 0.01,
                                                 .work_limit = work_limit,
                                                 .work = work,
                                                 .measure = measure,
                                                 .user = terrain});
}

// The least work, by trying all points.
static double least_work(const struct terrain *terrain)
{
    double least = INFINITY;

    for (int i = 0; i <= 20; i++)
        for (int k = 0; k <= 20; k++) {
            struct plan_point point = {.rungs = {i, k}};

            if (error_of(terrain, &point) <= 0.01) least = fmin(least, work(NULL, &point));
        }
    return least;
}

static void the_cheapest_point_is_found_from_anywhere(void **state)
{
    static const struct plan_point starts[] = {
        {.rungs = {0, 0}}, {.rungs = {20, 20}}, {.rungs = {0, 14}}, {.rungs = {14, 0}}, {.rungs = {7, 7}}};

    for (size_t i = 0; i < sizeof starts / sizeof *starts; i++)
        for (int share = -3; share <= 3; share++) {
            struct terrain terrain = {.shares = {1.0, exp2(share)}};
            struct plan_finding finding = search(&terrain, starts[i], INFINITY);

            assert_int_equal(finding.found, PLAN_FOUND);
            assert_true(finding.error <= 0.01);
            // The walk does not try exchanges of one rung for several of another axis.
            assert_true(finding.work <= 1.25 * least_work(&terrain));
            assert_int_equal(finding.measured, terrain.measured);
        }
}

static void few_points_are_measured_far_below_the_target(void **state)
{
    struct terrain terrain = {.shares = {1.0, 1.0}};
    struct plan_finding finding = search(&terrain, (struct plan_point){.rungs = {20, 20}}, INFINITY);

    (void)state;
    assert_true(finding.work <= 1.25 * least_work(&terrain));
    print_message("%d points\n", finding.measured);
    assert_in_range(finding.measured, 3, 15);
}

static void an_axis_that_does_nothing_is_left_coarse(void **state)
{
    struct terrain terrain = {.shares = {1.0, 0.0}};

    assert_int_equal(search(&terrain, (struct plan_point){.rungs = {10, 10}}, INFINITY).point.rungs[1], 0);
}

static void points_over_the_work_limit_are_not_measured(void **state)
{
    struct terrain terrain = {.shares = {1.0, 1.0}};
    double least = least_work(&terrain);
    struct plan_finding finding = search(&terrain, (struct plan_point){.rungs = {0, 0}}, 0.5 * least);

    assert_int_equal(finding.found, PLAN_OVER_LIMIT);
    assert_true(finding.work < 0.5 * least);
}

static void points_that_cannot_be_measured_are_avoided(void **state)
{
    struct terrain terrain = {.shares = {1.0, 0.1}, .cannot_from = 5};
    struct plan_finding finding = search(&terrain, (struct plan_point){.rungs = {8, 8}}, INFINITY);

    assert_int_equal(finding.found, PLAN_MISSED);
    assert_true(finding.point.rungs[0] < 5 && isfinite(finding.error));
}

static void a_search_stops_when_it_is_told(void **state)
{
    struct terrain terrain = {.shares = {1.0, 1.0}, .stop_after = 3};

    assert_int_equal(search(&terrain, (struct plan_point){.rungs = {0, 0}}, INFINITY).found, PLAN_GAVE_UP);
    assert_int_equal(terrain.measured, 3);
}

static struct job job_of(const char *frames)
{
    struct job job = {0};

    assert_true(frame_range_parse(&job.frames, frames, NULL));
    return job;
}

static void segments_share_out_the_range_in_its_order(void **state)
{
    struct job job = job_of("0-99");
    struct plan_segment second = plan_segment_of(&job, 48), last = plan_segment_of(&job, 99);

    assert_true(plan_segment_count(&job) == 3 && plan_segment_of(&job, 47).index == 0);
    assert_true(second.index == 1 && second.first == 48 && second.count == 48 && second.pilot_count == 3);
    assert_true(second.pilot[0] == 48 && second.pilot[1] == 71 && second.pilot[2] == 95);
    assert_true(last.count == 4 && last.pilot[0] == 96 && last.pilot[1] == 97 && last.pilot[2] == 99);
    frame_range_finish(&job.frames);
}

static void a_range_backwards_has_the_same_pilot(void **state)
{
    struct job job = job_of("239,120,0"), single = job_of("7");
    struct plan_segment segment = plan_segment_of(&job, 239);

    assert_true(segment.pilot_count == 3 && segment.pilot[0] == 0 && segment.pilot[1] == 120 &&
                segment.pilot[2] == 239);
    assert_int_equal(plan_segment_of(&single, 7).pilot_count, 1);
    frame_range_finish(&job.frames);
    frame_range_finish(&single.frames);
}

// Frames of a scene in which nothing moves are copies.
static void copies_of_a_still_scene_count_once(void **state)
{
    struct job job = job_of("0-99");
    struct plan_segment segment = plan_segment_of(&job, 3);

    assert_true(plan_segment_pictures(&job, &segment) == 1.0);
    job.scene.camera.fov = (struct timeline){.kind = TIMELINE_LINEAR, .component_count = 1, .linear.rate = {1.0}};
    assert_true(plan_segment_pictures(&job, &segment) == 48.0);
    frame_range_finish(&job.frames);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_cheapest_point_is_found_from_anywhere),
        cmocka_unit_test(few_points_are_measured_far_below_the_target),
        cmocka_unit_test(an_axis_that_does_nothing_is_left_coarse),
        cmocka_unit_test(points_over_the_work_limit_are_not_measured),
        cmocka_unit_test(points_that_cannot_be_measured_are_avoided),
        cmocka_unit_test(a_search_stops_when_it_is_told),
        cmocka_unit_test(segments_share_out_the_range_in_its_order),
        cmocka_unit_test(a_range_backwards_has_the_same_pilot),
        cmocka_unit_test(copies_of_a_still_scene_count_once),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
