// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/scene_extent.h"

#include "core/base/error.h"
#include "tests/support/ball_job.h"
#include "worker/scene/scene_inputs.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static struct scene_extent find(const struct job *job)
{
    struct scene_inputs inputs = {0};
    struct scene_extent extent;

    assert_true(scene_inputs_open(&inputs, job, 0, NULL, NULL, NULL));
    extent = scene_extent_find(job, &inputs, 0);
    scene_inputs_finish(&inputs);
    return extent;
}

// A ball of radius 1, 4 m ahead.
static void extent_is_the_balls(void **state)
{
    struct scene_extent extent;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    job.scene.camera.clip_near = 0;
    job.scene.camera.clip_far = INFINITY;
    extent = find(&job);
    assert_true(extent.near <= 3 && extent.near > 2.99);
    assert_true(extent.far >= 5 && extent.far < 5.01);
    assert_float_equal(extent.length, 2, 1e-3);
    assert_float_equal(extent.voxel, 0, 0);
    job_finish(&job);
}

static void clip_ends_what_media_do_not(void **state)
{
    struct scene_extent extent;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    job.scene.camera.clip_near = 3.5;
    job.scene.camera.clip_far = 4.5;
    extent = find(&job);
    assert_float_equal(extent.near, 3.5, 0);
    assert_float_equal(extent.far, 4.5, 0);
    assert_float_equal(extent.length, 1, 1e-12);
    job_finish(&job);
}

static void media_outside_of_the_clip_leave_the_clip(void **state)
{
    struct scene_extent extent;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    job.scene.camera.clip_near = 10;
    job.scene.camera.clip_far = 11;
    extent = find(&job);
    assert_float_equal(extent.near, 10, 0);
    assert_float_equal(extent.far, 11, 0);
    job_finish(&job);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(extent_is_the_balls),
        cmocka_unit_test(clip_ends_what_media_do_not),
        cmocka_unit_test(media_outside_of_the_clip_leave_the_clip),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
