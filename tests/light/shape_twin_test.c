// Spans of rays in half spaces, and normals of surfaces, against formulas in double precision.
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
#include <string.h>

#include <cmocka.h>

enum { COUNT = 512 };

// Relative rounding error of a float: half the distance from one float to the next.
static const double ROUNDING = 0x1p-24;

static float inputs[SHADER_PROBE_INPUT_LIMIT][4];
static float outputs[COUNT][4];

static void probe(const char *body, bool on_egl)
{
    static const char *const modules[] = {
        "math/constants.glsl", "region/span.glsl",    "region/sphere.glsl", "region/box.glsl",
        "region/plane.glsl",   "surface/sphere.glsl", "surface/box.glsl",   NULL};

    shader_probe_run(&(struct shader_probe_params){.modules = modules,
                                                   .body = body,
                                                   .inputs = (const float(*)[4])inputs,
                                                   .input_count = SHADER_PROBE_INPUT_LIMIT,
                                                   .count = COUNT,
                                                   .on_egl = on_egl},
                     outputs);
}

// The plane's normal is (0.6, 0.8, 0), its point (1, 2, 3): heights above it are 0.6 x + 0.8 y - 2.2.
static void assert_planes_are_met(bool on_egl)
{
    struct vec3 normal = {0.6, 0.8, 0}, point = {1, 2, 3};
    struct random random = {47};

    for (size_t i = 0; i < COUNT; ++i) {
        probe_put_vector(inputs[2 * i],
                         vec3_add(point, vec3_scale(probe_any_direction(&random), random_between(&random, 0, 10))));
        probe_put_vector(inputs[2 * i + 1], probe_any_direction(&random));
    }
    probe("vec4 probe(int i)\n{\n    RegionPlane plane = RegionPlane(vec3(1.0, 2.0, 3.0), vec3(0.6, 0.8, 0.0));\n"
          "    return vec4(region_plane_span(plane, inputs[2 * i].xyz, inputs[2 * i + 1].xyz), 0.0, 0.0);\n}\n",
          on_egl);
    for (size_t i = 0; i < COUNT; ++i) {
        double height = vec3_dot(normal, vec3_subtract(probe_vector(inputs[2 * i]), point));
        double way = vec3_dot(normal, probe_vector(inputs[2 * i + 1])), crossing = -height / way;
        int near = way < 0 ? 0 : 1;

        // Heights reach 10 and have some roundings of that; the ray's slope has as many.
        assert_near(outputs[i][near], crossing, 100 * ROUNDING / fabs(way) + 8 * ROUNDING * fabs(crossing / way));
        assert_true(outputs[i][1 - near] == (way < 0 ? 1e18f : -1e18f));
    }
}

static void planes_are_met_where_heights_are_0(void **state)
{
    assert_planes_are_met(false);
    assert_planes_are_met(true);
}

// The rays run along the plane: a ray is in the half space as a whole or not at all. In the plane itself the span may
// be anything but NaN.
static void rays_along_planes_are_in_or_out(void **state)
{
    memset(inputs, 0, sizeof inputs);
    for (size_t i = 0; i < COUNT; ++i) {
        inputs[i][0] = (float)(pow(10, (double)(i / 3 % 24) - 12) * ((double)(i % 3) - 1));
        inputs[i][1] = i / 72 % 2 ? 1e-30f : 0;
        if (i / 144 % 2) inputs[i][1] = -inputs[i][1];
    }
    probe("vec4 probe(int i)\n{\n    RegionPlane plane = RegionPlane(vec3(0.0), vec3(0.0, 1.0, 0.0));\n"
          "    return vec4(region_plane_span(plane, vec3(7.0, inputs[i].x, 8.0), vec3(1.0, inputs[i].y, 0.0)), 0.0, "
          "0.0);\n}\n",
          false);
    for (size_t i = 0; i < COUNT; ++i) {
        // A tilted ray that starts within a hundredth of the plane meets it before 1e18 m.
        bool is_far = fabsf(inputs[i][0]) > 0.02f;

        assert_true(fabsf(outputs[i][0]) <= 1e18f && fabsf(outputs[i][1]) <= 1e18f);
        if (is_far && inputs[i][0] < 0) assert_true(outputs[i][0] == -1e18f && outputs[i][1] == 1e18f);
        if (is_far && inputs[i][0] > 0) assert_true(outputs[i][0] == 1e18f && outputs[i][1] == -1e18f);
    }
}

static void normals_face_out_of_balls(void **state)
{
    struct random random = {41};

    for (size_t i = 0; i < COUNT; ++i) {
        double size = pow(10, random_between(&random, -25, 17));

        probe_put_vector(inputs[i], vec3_scale(probe_any_direction(&random), i == 0 ? 0 : size));
        inputs[i][3] = (float)size;
    }
    probe("vec4 probe(int i)\n{\n"
          "    return vec4(surface_sphere_normal(RegionSphere(vec3(0.0), inputs[i].w), inputs[i].xyz), 0.0);\n}\n",
          false);
    assert_near(vec3_length(probe_vector(outputs[0])), 1, 4 * ROUNDING);
    for (size_t i = 1; i < COUNT; ++i) {
        struct vec3 wanted = vec3_normalize(probe_vector(inputs[i]));

        assert_near(vec3_length(vec3_subtract(probe_vector(outputs[i]), wanted)), 0, 8 * ROUNDING);
    }
}

// Points lie on faces, moved off them by a little; the last ones lie on edges and in the middle.
static void normals_of_boxes_are_the_nearest_faces(void **state)
{
    static const double half[] = {1, 0.02, 30};
    struct random random = {43};

    memset(inputs, 0, sizeof inputs);
    for (size_t i = 0; i < COUNT - 32; ++i)
        for (size_t c = 0; c < 3; ++c)
            inputs[i][c] = (float)(i % 3 == c ? (i % 2 ? -1 : 1) * half[c] + random_between(&random, -1e-4, 1e-4)
                                              : 0.99 * half[c] * random_between(&random, -1, 1));
    for (size_t i = COUNT - 32; i < COUNT; ++i)
        for (size_t c = 0; c < 3; ++c)
            inputs[i][c] = (float)(half[c] * (double)((int)(i >> c & 1) - (int)(i >> 3 & 1)));
    probe("vec4 probe(int i)\n{\n"
          "    return vec4(surface_box_normal(RegionBox(vec3(5.0, 6.0, 7.0), vec3(1.0, 0.02, 30.0)),\n"
          "                                   vec3(5.0, 6.0, 7.0) + inputs[i].xyz), 0.0);\n}\n",
          false);
    for (size_t i = 0; i < COUNT; ++i) {
        assert_true(vec3_length(probe_vector(outputs[i])) == 1);
        if (i < COUNT - 32) assert_true(outputs[i][i % 3] == (i % 2 ? -1.0f : 1.0f));
    }
}

// The one argument is a pattern of the tests to run.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(planes_are_met_where_heights_are_0),
        cmocka_unit_test(rays_along_planes_are_in_or_out),
        cmocka_unit_test(normals_face_out_of_balls),
        cmocka_unit_test(normals_of_boxes_are_the_nearest_faces),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
