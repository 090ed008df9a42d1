// The noise of the shaders against its twin in reference/, on the same inputs rounded to float.
// SPDX-License-Identifier: Apache-2.0
#include "reference/density_noise.h"
#include "tests/support/assert_near.h"
#include "tests/support/random.h"
#include "tests/support/shader_probe.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

enum { COUNT = SHADER_PROBE_INPUT_LIMIT };

// ROUNDING is half the relative distance between adjacent floats.
static const double ROUNDING = 0x1p-24;
// A weight's polynomial has terms of up to 9, so that its error is up to 20 roundings of 1. Three weights blend ramps
// that differ by up to 2. Hardly ever are all of them at their worst.
static const double OCTAVE_TOLERANCE = 40.0 * 0x1p-24;

static float inputs[COUNT][4];
static float outputs[COUNT][4];

static void probe(const char *const *modules, const char *body)
{
    shader_probe_run(&(struct shader_probe_params){.modules = modules,
                                                   .body = body,
                                                   .inputs = (const float(*)[4])inputs,
                                                   .input_count = COUNT,
                                                   .count = COUNT},
                     outputs);
}

static struct vec3 vector_of(const float value[4])
{
    return (struct vec3){value[0], value[1], value[2]};
}

static void put_random_point(struct random *random, size_t at, double half_size)
{
    for (int c = 0; c < 3; c++)
        inputs[at][c] = (float)random_between(random, -half_size, half_size);
}

// Compares the noise at all `inputs`. Returns how many values are not 0.
static int compare_octaves(void)
{
    static const char *const MODULES[] = {"density/noise.glsl", NULL};
    int count = 0;

    probe(MODULES, "vec4 probe(int i) { return vec4(density_noise(inputs[i].xyz)); }\n");
    for (size_t i = 0; i < COUNT; i++) {
        assert_near(outputs[i][0], density_noise_octave(vector_of(inputs[i])), OCTAVE_TOLERANCE);
        count += outputs[i][0] != 0.0f;
    }
    return count;
}

static void noise_is_its_twin_at_random_points(void **state)
{
    struct random random = {21};

    // Each entry of the permutation is read for x, and some sixteen times for a gradient.
    for (size_t i = 0; i < COUNT; i++) {
        put_random_point(&random, i, 300.0);
        inputs[i][0] = (float)(random_between(&random, 0.0, 1.0) + (double)i - 512.0);
    }
    assert_true(compare_octaves() > COUNT - 10);
}

static void noise_is_its_twin_on_the_faces_of_cells(void **state)
{
    struct random random = {22};

    for (size_t i = 0; i < COUNT; i++) {
        put_random_point(&random, i, 5.0);
        inputs[i][i % 3] = floorf(inputs[i][i % 3]);
        // A coordinate's fraction may round to 1 just below a face.
        if (i % 4 == 0) inputs[i][(i + 1) % 3] = -1e-9f;
        if (i % 4 == 1) inputs[i][(i + 1) % 3] = nextafterf(roundf(inputs[i][(i + 1) % 3]), -INFINITY);
    }
    assert_true(compare_octaves() > COUNT / 2);
}

// Coordinates have a fraction up to 2^24 and none beyond. From 2^31 on they do not fit an int either.
static void noise_is_its_twin_at_large_coordinates(void **state)
{
    struct random random = {23};

    for (size_t i = 0; i < COUNT; i++)
        put_random_point(&random, i, 1e6);
    assert_true(compare_octaves() > COUNT / 2);
    for (size_t i = 0; i < COUNT; i++)
        put_random_point(&random, i, i % 2 ? 1e12 : 1e30);
    assert_int_equal(compare_octaves(), 0);
}

// Sums five octaves as a scene's shader does. `octave` and `shape` are GLSL: expressions of its `octave` and `sum`.
static void compare_mode(enum scene_noise_mode mode, const char *module, const char *octave, const char *shape)
{
    const char *modules[] = {"density/noise.glsl", module, "density/noise_bias.glsl", NULL};
    struct random random = {24};
    struct density_noise noise;
    char body[1024];
    int empty = 0;

    snprintf(body, sizeof body,
             "vec4 probe(int i) {\n"
             "    vec3 q = inputs[i].xyz;\n    float sum = 0.0;\n    float gain = 1.0;\n"
             "    for (int k = 0; k < 5; ++k) {\n"
             "        float octave = density_noise(q);\n        sum += gain * %s;\n"
             "        q *= 2.125;\n        gain *= %.9g;\n    }\n"
             "    return vec4(density_noise_bias(%s, 0.6 / 1.4));\n"
             "}\n",
             octave, pow(2.125, -0.4), shape);
    for (size_t i = 0; i < COUNT; i++)
        put_random_point(&random, i, 4.0);
    probe(modules, body);
    density_noise_init(&noise, &(struct density_noise_params){.octaves = 5,
                                                              .mode = mode,
                                                              .frequency = 1.0,
                                                              .lacunarity = 2.125,
                                                              .hurst = 0.4,
                                                              .bias = 0.4,
                                                              .axis = {0.0, 1.0, 0.0},
                                                              .scale = 1.0});
    for (size_t i = 0; i < COUNT; i++) {
        double wanted = density_noise(&noise, vector_of(inputs[i]));

        // The finest octave has a slope of 2, and coordinates up to 82 with four roundings. Values are compared before
        // the power 3/7, whose slope is infinite at 0.
        double sum_tolerance = 5.0 * OCTAVE_TOLERANCE + 2.0 * 4.0 * 82.0 * ROUNDING;

        assert_near(pow(outputs[i][0], 7.0 / 3.0), pow(wanted, 7.0 / 3.0), 2.0 * sum_tolerance);
        empty += wanted == 0.0;
    }
    if (mode == SCENE_NOISE_CLIP) assert_in_range(empty, COUNT / 4, 3 * COUNT / 4);
    if (mode == SCENE_NOISE_ABSOLUTE) assert_int_equal(empty, 0);
}

static void modes_are_their_twins(void **state)
{
    compare_mode(SCENE_NOISE_REMAP, "density/noise_remap.glsl", "octave", "density_noise_remap(sum)");
    compare_mode(SCENE_NOISE_CLIP, "density/noise_clip.glsl", "octave", "density_noise_clip(sum)");
    compare_mode(SCENE_NOISE_ABSOLUTE, "density/noise_absolute.glsl", "density_noise_absolute(octave)", "sum");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_is_its_twin_at_random_points),
        cmocka_unit_test(noise_is_its_twin_on_the_faces_of_cells),
        cmocka_unit_test(noise_is_its_twin_at_large_coordinates),
        cmocka_unit_test(modes_are_their_twins),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
