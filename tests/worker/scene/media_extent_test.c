// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/media_extent.h"

#include "core/job/job.h"
#include "tests/support/assert_near.h"
#include "tests/support/ball_job.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const struct media_extent ball = {.has_ball = true, .center = {1, 2, 3}, .radius = 0.5};
static const struct media_extent box = {.has_box = true, .low = {-1, -2, 4}, .high = {3, 2, 6}};
static const double across[3] = {1, 0, 0}, along[3] = {0, 0, 1}, origin[3] = {0};

static void reach_is_that_of_what_both_hold(void **state)
{
    struct media_extent both = {
        .has_ball = true, .has_box = true, .center = {0, 0, 5}, .radius = 2, .low = {-1, -2, 4}, .high = {3, 2, 6}};
    const double oblique[3] = {0.6, 0.8, 0};

    (void)state;
    assert_near(media_extent_support(&ball, oblique), 0.6 + 1.6 + 0.5, 1e-12);
    assert_near(media_extent_support(&box, oblique), 1.8 + 1.6, 1e-12);
    assert_near(media_extent_support(&both, oblique), 2, 1e-12);
    assert_near(media_extent_support(&both, along), 6, 1e-12);
}

static void distances_hold_every_point(void **state)
{
    double near, far;

    (void)state;
    media_extent_distances(&ball, origin, &near, &far);
    assert_near(near, sqrt(14) - 0.5, 1e-12);
    assert_near(far, sqrt(14) + 0.5, 1e-12);
    media_extent_distances(&box, origin, &near, &far);
    assert_near(near, 4, 1e-12);
    assert_near(far, 7, 1e-12);
    media_extent_distances(&ball, ball.center, &near, &far);
    assert_near(near, 0, 0);
}

static void tangents_hold_every_point(void **state)
{
    const double aside[3] = {-1, 0, 0};

    (void)state;
    assert_near(media_extent_tangent(&box, origin, across, along), 0.75, 1e-12);
    assert_near(media_extent_tangent(&box, origin, aside, along), 0.25, 1e-12);
    // The ball's disc in the plane of both axes: half-angle asin(0.5 / sqrt(10)) about atan(1/3).
    assert_near(media_extent_tangent(&ball, origin, across, along), tan(atan(1.0 / 3) + asin(0.5 / sqrt(10))), 1e-12);
    assert_true(isinf(media_extent_tangent(&ball, ball.center, across, along)));
    assert_true(isinf(media_extent_tangent(&box, (double[3]){0, 0, 5}, across, along)));
}

static void a_medium_is_where_its_density_and_its_bounds_are(void **state)
{
    struct job job;
    struct media_extent extent;

    (void)state;
    ball_job_parse(&job, BALL_JOB_SIGMA_S_1, BALL_JOB_POINT_LIGHT "," BALL_JOB_MIDPOINT);
    extent = media_extent_of(&job, NULL, 0, 0);
    assert_true(extent.has_ball && !extent.has_box);
    assert_near(extent.radius, 1, 1e-12);
    assert_true(media_extent_is_still(&job.scene.media[0].density));
    job.scene.media[0].density.kind = SCENE_DENSITY_HOMOGENEOUS; // which is everywhere
    extent = media_extent_of(&job, NULL, 0, 0);
    assert_true(!extent.has_ball && !extent.has_box);
    job_finish(&job);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reach_is_that_of_what_both_hold),
        cmocka_unit_test(distances_hold_every_point),
        cmocka_unit_test(tangents_hold_every_point),
        cmocka_unit_test(a_medium_is_where_its_density_and_its_bounds_are),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
