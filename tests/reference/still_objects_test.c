// Objects of a job at one moment.
// SPDX-License-Identifier: Apache-2.0
#include "reference/still.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "reference/reference.h"
#include "tests/support/assert_near.h"
#include "tests/support/job_text.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void parse(struct job *job, const char *text)
{
    struct error error = {{0}};

    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

static void every_number_is_taken_over(void **state)
{
    static const float texel[3];
    const struct material *material;
    struct still_inputs inputs = {0};
    struct still still;
    struct job job;

    parse(&job, job_text_objects);
    still_init(&still, &job, 2.0);
    assert_false(still.is_complete);
    inputs.textures[0] = (struct still_texture){texel, 1, 1};
    inputs.textures[3] = (struct still_texture){texel, 1, 1};
    inputs.textures[4] = (struct still_texture){texel, 1, 1};
    still_init_with_inputs(&still, &job, 0.5, &inputs);
    assert_true(still.is_complete);
    assert_int_equal(still.max_depth, 3);
    assert_near(still.min_throughput, 0.0625, 0.0);
    assert_int_equal(still.objects.count, 6);
    assert_near(still.objects.shapes[0].normal.y, 2.0 / sqrt(4.25), 1e-15);
    assert_near(still.objects.shapes[0].center.y, -1.0, 0.0);
    assert_near(still.objects.shapes[1].radius, 1.25, 0.0);
    assert_near(vec3_length(still.objects.shapes[1].center), 1.0, 1e-12);
    assert_near(still.objects.shapes[2].half.z, 1.5, 0.0);
    assert_int_equal(still.objects.list[4].first_shape, 4);
    assert_int_equal(still.objects.list[4].shape_count, 3);
    material = &still.objects.list[0].material;
    assert_near(material->albedo[1], 0.75, 0.0);
    assert_near(material->specular, 0.75, 1e-15);
    assert_near(material->roughness, 0.25, 0.0);
    assert_near(material->ior, 1.25, 0.0);
    assert_true(material->fresnel.has_f0 && material->fresnel.kind == SCENE_FRESNEL_SCHLICK);
    assert_near(material->fresnel.f0, 0.125, 0.0);
    assert_near(material->fresnel.f90, 0.75, 0.0);
    assert_ptr_equal(material->texture.rgb, texel);
    assert_true(material->texture.is_nearest);
    assert_near(material->texture.size[1], 0.5, 0.0);
    material = &still.objects.list[1].material;
    assert_near(material->ior, 1.75, 0.0);
    assert_false(material->fresnel.has_f0);
    assert_near(still.objects.list[2].material.reflectance[2], 0.25, 0.0);
    job_finish(&job);
}

static void interiors_fill_their_objects(void **state)
{
    struct still_media media;
    struct still still;
    struct job job;

    parse(&job, job_text_objects);
    still_init(&still, &job, 0.0);
    assert_int_equal(still.medium_count, 3);
    media = still_media(&still, 0);
    assert_int_equal(media.count, 1);
    assert_near(media.list[0].sigma_s[0], 1.0, 0.0);
    media = still_media(&still, 2);
    assert_int_equal(media.count, 1);
    assert_near(media.list[0].sigma_a[0], 0.75, 0.0);
    media = still_media(&still, 6);
    assert_int_equal(media.count, 1);
    assert_near(media.list[0].sigma_s[0], 1.0, 0.0);
    assert_int_equal(still_media(&still, 3).count, 0);
    job_finish(&job);
}

// The camera looks down on a rough mirror; a black ball is far above it before a white sky.
static const char ROUGH[] =
    "{\"version\": 1, \"name\": \"rough\", \"frames\": \"0-9\", \"fps\": 10, \"resolution\": [1, 1],"
    " \"camera\": {\"position\": [0, 0.5, 0], \"target\": [0, 0, 0], \"up\": [0, 0, 1], \"fov\": 40},"
    " \"lights\": [], \"background\": 1, \"scene\": {\"media\": [], \"objects\": ["
    " {\"kind\": \"plane\", \"point\": [0, 0, 0], \"material\": {\"kind\": \"mirror\", \"roughness\": 0.6}},"
    " {\"kind\": \"sphere\", \"center\": [0, 3, 0], \"radius\": {\"start\": 2.4, \"rate\": -2},"
    " \"material\": {\"kind\": \"diffuse\", \"albedo\": 0}}]},"
    " \"quality\": {\"method\": \"midpoint\", \"step\": 0.05, \"light_step\": 0.05},"
    " \"output\": {\"path\": \"rough.####.exr\"}}";

// Normals end in random points of a ball of radius r about the tip of the true normal. A share of cos a sqrt(r^2 -
// sin^2 a) / r of them leans by more than an angle a. The reflected ray turns by twice the angle of its normal.
static void means_of_rough_samples_are_as_known(void **state)
{
    enum { SAMPLES = 4000 };
    static struct reference_sample samples[SAMPLES];
    double time = 0.75, half = 0.5 * asin((2.4 - 2.0 * time) / 3.0);
    double wanted = cos(half) * sqrt(0.36 - sin(half) * sin(half)) / 0.6;
    struct reference_pixel pixel;
    struct job job;

    parse(&job, ROUGH);
    for (int i = 0; i < SAMPLES; i++)
        samples[i] = (struct reference_sample){0.5, 0.5, time, (uint64_t)i};
    pixel = reference_measure_samples(&job, NULL, 0, 0, samples, SAMPLES, NULL);
    // Each sample sees either the ball or the sky.
    assert_near(pixel.radiance_error[0], sqrt(pixel.radiance[0] * (1.0 - pixel.radiance[0]) / (SAMPLES - 1)), 1e-12);
    assert_near(pixel.radiance[0], wanted, 3.0 * pixel.radiance_error[0]);
    assert_near(pixel.ray_count, 2.0, 1e-9);
    assert_near(pixel.cut_count, 0.0, 0.0);
    // One sample has no error estimate.
    assert_near(reference_measure_samples(&job, NULL, 0, 0, samples, 1, NULL).radiance_error[0], 0.0, 0.0);
    job_finish(&job);
}

static void samples_stop_objects_at_their_moments(void **state)
{
    struct reference_sample samples[] = {{0.5, 0.5, 0.0, 1}, {0.5, 0.5, 1.0, 1}};
    struct reference_pixel pixel;
    struct still still;
    struct job job;

    parse(&job, ROUGH);
    still_init(&still, &job, 1.0);
    assert_near(still.objects.shapes[1].radius, 0.4, 1e-15);
    job.scene.objects[0].material.roughness.value[0] = 0.0;
    // The ball is right above the mirror at both times; beside the axis it is smaller at the second time.
    samples[0].x = samples[1].x = 1.7;
    pixel = reference_measure_samples(&job, NULL, 0, 0, samples, 2, NULL);
    assert_near(pixel.radiance[0], 0.5, 1e-15);
    job_finish(&job);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_number_is_taken_over),
        cmocka_unit_test(interiors_fill_their_objects),
        cmocka_unit_test(means_of_rough_samples_are_as_known),
        cmocka_unit_test(samples_stop_objects_at_their_moments),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
