// Normals of rough surfaces: their distribution, repeated draws, and rays that they send to the wrong side.
// SPDX-License-Identifier: Apache-2.0
#include "reference/vec3.h"
#include "tests/support/assert_near.h"
#include "tests/support/probe_vectors.h"
#include "tests/support/random.h"
#include "tests/support/shader_probe.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

enum { COUNT = 512, DRAW_COUNT = 4096 };

// ROUNDING is half the relative distance between adjacent floats.
static const double ROUNDING = 0x1p-24;

static float inputs[SHADER_PROBE_INPUT_LIMIT][4];
static float outputs[DRAW_COUNT][4];

static void probe(const char *body, size_t count, bool on_egl)
{
    static const char *const modules[] = {"math/random.glsl", "surface/rough.glsl", NULL};

    shader_probe_run(&(struct shader_probe_params){.modules = modules,
                                                   .body = body,
                                                   .inputs = (const float(*)[4])inputs,
                                                   .input_count = SHADER_PROBE_INPUT_LIMIT,
                                                   .count = count,
                                                   .on_egl = on_egl},
                     outputs);
}

static int compare(const void *a, const void *b)
{
    double left = *(const double *)a, right = *(const double *)b;

    return (left > right) - (left < right);
}

// Kolmogorov's distance of the values from a uniform distribution between `low` and `high`, in units of
// 1 / sqrt(count). It is over 2 less than once in a thousand times.
static double distance_from_uniform(double *values, size_t count, double low, double high)
{
    double most = 0;

    qsort(values, count, sizeof *values, compare);
    for (size_t i = 0; i < count; ++i) {
        double share = (values[i] - low) / (high - low);

        most = fmax(most, fmax(fabs(share - (double)i / (double)count), fabs(share - (double)(i + 1) / (double)count)));
    }
    return most * sqrt((double)count);
}

// Draws DRAW_COUNT normals of a surface that faces up (z). The ray hits it with this cosine and travels towards +x.
static void draw_normals(double cos_in, double roughness, bool on_egl)
{
    probe_put_vector(inputs[0], (struct vec3){sqrt(1 - cos_in * cos_in), 0, -cos_in});
    inputs[0][3] = (float)roughness;
    probe("vec4 probe(int i)\n{\n    random_start(uvec2(uint(i), 7u), 0u, 3u);\n    uint before = random_state;\n"
          "    vec3 facet = rough_normal(vec3(0.0, 0.0, 1.0), inputs[0].xyz, inputs[0].w);\n"
          "    return vec4(facet, before == random_state ? 0.0 : 1.0);\n}\n",
          DRAW_COUNT, on_egl);
    for (size_t i = 0; i < DRAW_COUNT; ++i)
        assert_near(vec3_length(probe_vector(outputs[i])), 1, 4 * ROUNDING);
}

// The mean unit vector from a point outside a sphere to its surface is the gradient of their mean distance,
// R + r^2 / (3 R). Here R = 1.
static void normals_spread_with_roughness(void **state)
{
    static const double spreads[] = {0.05, 0.3, 0.7, 1};

    for (int k = 0; k < 8; ++k) {
        double r = spreads[k % 4];
        struct vec3 mean = {0, 0, 0};

        draw_normals(1, r, k >= 4);
        for (size_t i = 0; i < DRAW_COUNT; ++i)
            mean = vec3_add(mean, vec3_scale(probe_vector(outputs[i]), 1.0 / DRAW_COUNT));
        // Tolerances are four standard errors: no component varies by more than r.
        assert_near(mean.x, 0, 4 * r / sqrt(3.0 * DRAW_COUNT));
        assert_near(mean.y, 0, 4 * r / sqrt(3.0 * DRAW_COUNT));
        assert_near(mean.z, 1 - r * r / 3, 2 * r * r / sqrt(DRAW_COUNT));
    }
}

// The point on the sphere is 2 (n' n) n' - n at roughness 1. The ray can meet points lower than its cosine. Heights on
// a sphere are uniform.
static void normals_are_drawn_again_until_the_ray_meets_them(void **state)
{
    static const double cosines[] = {1, 0.5, 0.1};
    static double heights[DRAW_COUNT], angles[DRAW_COUNT];

    for (int k = 0; k < 3; ++k) {
        struct vec3 up = {0, 0, 1}, incoming, side = {0, 1, 0}, third;

        draw_normals(cosines[k], 1, false);
        incoming = probe_vector(inputs[0]);
        third = vec3_cross(incoming, side);
        for (size_t i = 0; i < DRAW_COUNT; ++i) {
            struct vec3 facet = probe_vector(outputs[i]);
            struct vec3 point = vec3_subtract(vec3_scale(facet, 2 * facet.z), up);

            assert_true(facet.z > 0 && vec3_dot(facet, incoming) < 1e-6);
            heights[i] = vec3_dot(point, incoming);
            angles[i] = atan2(vec3_dot(point, side), vec3_dot(point, third));
        }
        assert_true(distance_from_uniform(heights, DRAW_COUNT, -1, cosines[k]) < 2);
        assert_true(distance_from_uniform(angles, DRAW_COUNT, -M_PI, M_PI) < 2);
    }
}

// A smooth surface draws no random numbers. A ray that can meet no facet gets the surface's normal, a ray along the
// surface gets a facet.
static void normals_that_cannot_be_drawn_are_the_surfaces_own(void **state)
{
    draw_normals(0.3, 0, false);
    for (size_t i = 0; i < DRAW_COUNT; ++i)
        assert_true(outputs[i][2] == 1.0f && outputs[i][3] == 0.0f);
    draw_normals(-1, 1, false);
    for (size_t i = 0; i < DRAW_COUNT; ++i)
        assert_true(outputs[i][2] == 1.0f && outputs[i][3] == 1.0f);
    draw_normals(0, 1, false);
    for (size_t i = 0; i < DRAW_COUNT; ++i)
        assert_true(outputs[i][2] > 0 && outputs[i][0] <= 0);
}

static void directions_are_mirrored_to_their_side(void **state)
{
    struct random random = {37};

    for (size_t i = 0; i < COUNT; ++i) {
        probe_put_vector(inputs[2 * i], probe_any_direction(&random));
        probe_put_vector(inputs[2 * i + 1], probe_any_direction(&random));
        inputs[2 * i][3] = i % 2 == 0 ? 1 : -1;
    }
    probe("vec4 probe(int i)\n{\n"
          "    return vec4(rough_side(inputs[2 * i + 1].xyz, inputs[2 * i].xyz, inputs[2 * i].w), 0.0);\n}\n",
          COUNT, false);
    for (size_t i = 0; i < COUNT; ++i) {
        struct vec3 n = probe_vector(inputs[2 * i]), d = probe_vector(inputs[2 * i + 1]),
                    out = probe_vector(outputs[i]);
        double side = inputs[2 * i][3];

        assert_near(vec3_dot(out, n), side * fabs(vec3_dot(d, n)), 8 * ROUNDING);
        // The component along the surface does not change.
        assert_near(vec3_length(vec3_cross(vec3_subtract(out, d), n)), 0, 8 * ROUNDING);
    }
}

// One argument: the tests to run, by a pattern.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normals_spread_with_roughness),
        cmocka_unit_test(normals_are_drawn_again_until_the_ray_meets_them),
        cmocka_unit_test(normals_that_cannot_be_drawn_are_the_surfaces_own),
        cmocka_unit_test(directions_are_mirrored_to_their_side),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
