// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_layers.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const struct job sparse = {.quality = {.method = JOB_METHOD_PATHS, .paths = 64, .step = 0.5, .pixels = {8, 0.1}},
                                  .scene = {.orders = SCENE_ORDERS_ALL, .has_background = true},
                                  .output = {.has_depth = true}};

static void paths_beside_a_march_have_two_layers(void **state)
{
    struct job job = sparse;

    (void)state;
    assert_true(job_layers_are_two(&job));
    job.quality.pixels.stride = 0;
    assert_true(job_layers_are_two(&job));
    job.scene.medium_count = 2;
    job.scene.media[0].density.kind = SCENE_DENSITY_HOMOGENEOUS;
    job.scene.media[1].density.kind = SCENE_DENSITY_NOISE;
    job.quality.step = 0.0;
    assert_false(job_layers_are_two(&job));
    job.quality.step_voxels = 1.0;
    assert_true(job_layers_are_two(&job));
    job.quality.step_voxels = 0.0;
    job.quality.pixels.stride = 8;
    assert_true(job_layers_are_two(&job));
    // Homogeneous media need no step.
    job.quality.pixels.stride = 0;
    job.scene.medium_count = 1;
    assert_true(job_layers_are_two(&job));
    job = sparse;
    job.quality.method = JOB_METHOD_MIDPOINT;
    assert_false(job_layers_are_two(&job));
}

static void what_is_seen_is_marched_without_lights(void **state)
{
    struct job job = sparse, seen;

    (void)state;
    job.scene.light_count = 3;
    job.scene.lights[0].kind = SCENE_LIGHT_SUN;
    job.scene.lights[1] = (struct scene_light){.kind = SCENE_LIGHT_DOME, .dome = {.is_visible = true}};
    job.scene.lights[2].kind = SCENE_LIGHT_DOME;
    seen = job_layers_seen(&job);
    assert_int_equal(seen.scene.light_count, 1);
    assert_true(seen.scene.lights[0].dome.is_visible);
    assert_int_equal(seen.scene.orders, 1);
    assert_int_equal(seen.quality.method, JOB_METHOD_MIDPOINT);
    assert_true(seen.quality.step == 0.5 && seen.quality.pixels.stride == 8 && seen.quality.paths == 0);
    assert_true(seen.scene.has_background && seen.output.has_depth && !seen.output.has_transmittance);
    assert_false(job_layers_are_two(&seen));
}

static void scattered_light_has_its_noise_for_a_transmittance(void **state)
{
    struct job scattered = job_layers_scattered(&sparse);

    (void)state;
    assert_true(scattered.output.has_transmittance && !scattered.output.has_depth);
    assert_int_equal(scattered.scene.orders, SCENE_ORDERS_ALL);
    assert_int_equal(scattered.quality.paths, 64);
}

static void skies_are_apart_from_interpolated_marches(void **state)
{
    struct job job = {.quality = {.method = JOB_METHOD_CACHED, .step = 0.5, .samples = 4, .pixels = {8, 0.1}},
                      .scene = {.orders = SCENE_ORDERS_ALL, .light_count = 2, .medium_count = 1},
                      .output = {.has_depth = true}};
    struct job lit, sky;

    (void)state;
    assert_false(job_layers_have_sky(&job));
    job.scene.lights[1] = (struct scene_light){.kind = SCENE_LIGHT_DOME};
    assert_false(job_layers_have_sky(&job));
    job.scene.lights[1].dome.is_visible = true;
    assert_true(job_layers_have_sky(&job));
    lit = job_layers_lit(&job);
    assert_int_equal(lit.scene.light_count, 2);
    assert_true(lit.output.has_transmittance && lit.output.has_depth && !lit.scene.lights[1].dome.is_visible);
    assert_false(job_layers_have_sky(&lit));
    sky = job_layers_sky(&job);
    assert_int_equal(sky.scene.light_count, 1);
    assert_int_equal(sky.scene.medium_count, 0);
    assert_int_equal(sky.quality.samples, 4);
    assert_int_equal(sky.quality.pixels.stride, 0);
    assert_true(sky.scene.lights[0].dome.is_visible);
    // Mirrors show the dome as well.
    job.scene.object_count = 1;
    assert_false(job_layers_have_sky(&job));
    job.scene.object_count = 0;
    job.quality.pixels.stride = 0;
    assert_false(job_layers_have_sky(&job));
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paths_beside_a_march_have_two_layers),
        cmocka_unit_test(what_is_seen_is_marched_without_lights),
        cmocka_unit_test(scattered_light_has_its_noise_for_a_transmittance),
        cmocka_unit_test(skies_are_apart_from_interpolated_marches),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
