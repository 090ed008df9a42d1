// Each shader module against its twin in reference/, on the same inputs rounded to float.
// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene.h"
#include "reference/camera_pinhole.h"
#include "reference/closed_form.h"
#include "reference/density_fold_fractal.h"
#include "reference/light.h"
#include "reference/phase_henyey_greenstein.h"
#include "tests/support/assert_near.h"
#include "tests/support/random.h"
#include "tests/support/shader_probe.h"
#include "worker/scene/camera_view.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { COUNT = 256 };

// Relative rounding error of a float: half the distance from one float to the next.
static const double ROUNDING = 0x1p-24;

static float inputs[SHADER_PROBE_INPUT_LIMIT][4];
static float outputs[COUNT][4];

static void probe(const char *const *modules, const char *body, size_t input_count)
{
    shader_probe_run(&(struct shader_probe_params){.modules = modules,
                                                   .body = body,
                                                   .inputs = (const float(*)[4])inputs,
                                                   .input_count = input_count,
                                                   .count = COUNT},
                     outputs);
}

static void put(size_t at, double x, double y, double z, double w)
{
    inputs[at][0] = (float)x;
    inputs[at][1] = (float)y;
    inputs[at][2] = (float)z;
    inputs[at][3] = (float)w;
}

static struct vec3 vector_of(const float value[4])
{
    return (struct vec3){value[0], value[1], value[2]};
}

static void put_random_vector(struct random *random, size_t at, double size, double w)
{
    double x = random_between(random, -size, size), y = random_between(random, -size, size);

    put(at, x, y, random_between(random, -size, size), w);
}

// Puts a unit vector at `index`, at `angle` to the one before it, or to z.
static void put_direction(struct random *random, size_t index, double angle, const float before[4], double w)
{
    struct vec3 axis = before ? vec3_normalize(vector_of(before)) : (struct vec3){0, 0, 1};
    struct vec3 any = {random_between(random, -1.0, 1.0), random_between(random, -1.0, 1.0), 0.3};
    struct vec3 side = vec3_normalize(vec3_subtract(any, vec3_scale(axis, vec3_dot(any, axis))));

    put(index, axis.x * cos(angle) + side.x * sin(angle), axis.y * cos(angle) + side.y * sin(angle),
        axis.z * cos(angle) + side.z * sin(angle), w);
}

static void phase_henyey_greenstein_is_its_twin(void **state)
{
    static const char *const MODULES[] = {"math/constants.glsl", "phase/henyey_greenstein.glsl", NULL};
    static const double SHARP[] = {0.999, -0.999, 0.0, 0.9999};
    struct random random = {11};

    for (size_t i = 0; i < COUNT; i++) {
        double g = i % 4 == 0 ? SHARP[i / 4 % 4] : random_between(&random, -0.99, 0.99);
        double angle = i % 2 == 0 ? pow(10.0, random_between(&random, -6.0, 0.0)) : random_between(&random, 0.0, M_PI);

        put_direction(&random, 2 * i, random_between(&random, 0.0, M_PI), NULL, g);
        put_direction(&random, 2 * i + 1, g < 0 ? M_PI - angle : angle, inputs[2 * i], 0.0);
    }
    probe(
        MODULES,
        "vec4 probe(int i) {\n"
        "    vec4 first = inputs[2 * i];\n"
        "    return vec4(phase_henyey_greenstein(PhaseHenyeyGreenstein(first.w), first.xyz, inputs[2 * i + 1].xyz));\n"
        "}\n",
        2 * COUNT);
    for (size_t i = 0; i < COUNT; i++) {
        struct vec3 incoming = vec3_normalize(vector_of(inputs[2 * i]));
        double g = inputs[2 * i][3];
        double wanted = phase_henyey_greenstein(g, vec3_dot(incoming, vec3_normalize(vector_of(inputs[2 * i + 1]))));
        // Rounding shortens unit vectors, which matters relative to the width of the peak.
        double shortened = pow(2.0 * ROUNDING / (1.0 - fabs(g)), 2.0);

        // The formula has a dozen operations, one of them to the power 3/2; the sum of two positive numbers loses no
        // digits.
        assert_near(outputs[i][0], wanted, (32.0 * ROUNDING + 1.5 * shortened) * wanted);
    }
}

static void phase_isotropic_is_its_twin(void **state)
{
    static const char *const MODULES[] = {"math/constants.glsl", "phase/isotropic.glsl", NULL};

    probe(MODULES, "vec4 probe(int i) { return vec4(phase_isotropic()); }\n", 0);
    assert_near(outputs[0][0], phase_henyey_greenstein(0.0, 0.3), ROUNDING);
}

// The matrix is the rotation about x, followed by the one about y.
static void put_rotation(size_t at, double x_rad, double y_rad)
{
    put(at, cos(y_rad), 0.0, -sin(y_rad), 0.0);
    put(at + 1, sin(x_rad) * sin(y_rad), cos(x_rad), sin(x_rad) * cos(y_rad), 0.0);
    put(at + 2, cos(x_rad) * sin(y_rad), -sin(x_rad), cos(x_rad) * cos(y_rad), 0.0);
}

static void density_fold_fractal_distance_is_its_twin(void **state)
{
    static const char *const MODULES[] = {"density/fold_fractal.glsl", NULL};
    enum { VECTORS = 4, POINTS = COUNT };
    static double x_rad[COUNT], y_rad[COUNT], offset[COUNT];
    struct random random = {12};

    for (size_t i = 0; i < POINTS; i++) {
        x_rad[i] = random_between(&random, -3.0, 3.0);
        y_rad[i] = random_between(&random, -3.0, 3.0);
        offset[i] = (float)random_between(&random, 0.0, 0.1);
        put_random_vector(&random, VECTORS * i, 1.0, offset[i]);
        put_rotation(VECTORS * i + 1, x_rad[i], y_rad[i]);
    }
    probe(MODULES,
          "vec4 probe(int i) {\n"
          "    mat3 rotation = mat3(inputs[4 * i + 1].xyz, inputs[4 * i + 2].xyz, inputs[4 * i + 3].xyz);\n"
          "    DensityFoldFractal density = DensityFoldFractal(8, rotation, inputs[4 * i].w, 0.15, 1.3, 10.0);\n"
          "    return vec4(density_fold_fractal_distance(density, inputs[4 * i].xyz));\n"
          "}\n",
          VECTORS * POINTS);
    for (size_t i = 0; i < POINTS; i++) {
        struct density_fold_fractal fractal;

        density_fold_fractal_init(&fractal, &(struct density_fold_fractal_params){.iterations = 8,
                                                                                  .offset = offset[i],
                                                                                  .radius = 0.15,
                                                                                  .exponent = 1.3,
                                                                                  .scale = 10.0,
                                                                                  .rotate_x_rad = x_rad[i],
                                                                                  .rotate_y_rad = y_rad[i]});
        // The eight iterations apply a matrix of rounded numbers, folds and shifts to a vector at most sqrt(3) long;
        // none amplifies an error.
        assert_near(outputs[i][0], density_fold_fractal_distance(&fractal, vector_of(inputs[VECTORS * i])),
                    8.0 * 8.0 * ROUNDING * sqrt(3.0));
    }
}

static void density_fold_fractal_at_is_its_twin(void **state)
{
    static const char *const MODULES[] = {"density/fold_fractal.glsl", NULL};
    struct random random = {13};

    for (size_t i = 0; i < COUNT; i++) {
        put(i, random_between(&random, -0.5, i % 4 ? 0.0 : 0.5), random_between(&random, 0.2, 4.0),
            random_between(&random, 0.0, 100.0), 0.0);
    }
    probe(MODULES,
          "vec4 probe(int i) {\n"
          "    DensityFoldFractal density = DensityFoldFractal(8, mat3(1.0), 0.1, 1.0, inputs[i].y, inputs[i].z);\n"
          "    return vec4(density_fold_fractal_at(density, inputs[i].x));\n"
          "}\n",
          COUNT);
    for (size_t i = 0; i < COUNT; i++) {
        struct density_fold_fractal fractal = {.radius = 1.0, .exponent = inputs[i][1], .scale = inputs[i][2]};
        double wanted = density_fold_fractal_folded(&fractal, (struct vec3){1.0 + (double)inputs[i][0], 0.0, 0.0});

        // pow(x, y) as exp2(y log2 x) has an absolute error in y log2 x of up to 4 * 11 * 2^-24. The driver's
        // polynomials add to that; they are good to about 2^-20.
        assert_near(outputs[i][0], wanted, 64.0 * ROUNDING * 4.0 * wanted);
    }
}

// Input 3 i is the point, 3 i + 1 the light's colour, 3 i + 2 its position or its direction of travel.
static void put_lights(void)
{
    struct random random = {14};

    for (size_t i = 0; i < COUNT; i++) {
        put_random_vector(&random, 3 * i, 3.0, 0.0);
        put(3 * i + 1, 3.0, 0.5, random_between(&random, 0.0, 100.0), 0.0);
        put_random_vector(&random, 3 * i + 2, 3.0, 0.0);
    }
}

// `field` is a vec4 expression of a LightSample.
static void probe_lights(const char *module, const char *sample, const char *field)
{
    const char *modules[] = {"math/constants.glsl", "math/spectrum_rgb.glsl", "light/sample.glsl", module, NULL};
    char body[512];

    snprintf(body, sizeof body, "vec4 probe(int i) {\n    LightSample light = %s;\n    return %s;\n}\n", sample, field);
    probe(modules, body, 3 * COUNT);
}

static void assert_lights(const struct light *like, const char *module, const char *sample)
{
    static float ways[COUNT][4];
    bool is_point = like->kind == SCENE_LIGHT_POINT;

    put_lights();
    probe_lights(module, sample, "vec4(light.direction, light.distance)");
    memcpy(ways, outputs, sizeof ways);
    probe_lights(module, sample, "vec4(light.irradiance, 0.0)");
    for (size_t i = 0; i < COUNT; i++) {
        struct light light = *like;
        struct light_arrival arrival;
        double tolerance;

        light.position = vector_of(inputs[3 * i + 2]);
        light.direction = vec3_normalize(light.position);
        for (int c = 0; c < 3; c++)
            light.intensity[c] = inputs[3 * i + 1][c];
        arrival = light_arrive(&light, vector_of(inputs[3 * i]));
        // The offset is a difference of two floats of size 3 at a distance that may be small; a handful of operations
        // follow.
        tolerance = ROUNDING * (16.0 + (is_point ? 6.0 / arrival.distance : 0.0));
        assert_near(ways[i][0], -arrival.travel.x, tolerance);
        assert_near(ways[i][1], -arrival.travel.y, tolerance);
        assert_near(ways[i][2], -arrival.travel.z, tolerance);
        if (is_point) assert_near(ways[i][3], arrival.distance, tolerance * arrival.distance);
        if (!is_point) assert_true(ways[i][3] > 1e17f);
        for (int c = 0; c < 3; c++)
            assert_near(outputs[i][c], arrival.irradiance[c], 2.0 * tolerance * arrival.irradiance[c]);
    }
}

static void light_point_is_its_twin(void **state)
{
    assert_lights(&(struct light){.kind = SCENE_LIGHT_POINT, .falloff = SCENE_FALLOFF_INVERSE_SQUARE},
                  "light/point.glsl",
                  "light_point(LightPoint(inputs[3 * i + 1].rgb, inputs[3 * i + 2].xyz), inputs[3 * i].xyz)");
}

static void light_point_even_is_its_twin(void **state)
{
    assert_lights(&(struct light){.kind = SCENE_LIGHT_POINT, .falloff = SCENE_FALLOFF_NONE}, "light/point_even.glsl",
                  "light_point_even(LightPointEven(inputs[3 * i + 1].rgb, inputs[3 * i + 2].xyz), inputs[3 * i].xyz)");
}

static void light_sun_is_its_twin(void **state)
{
    assert_lights(&(struct light){.kind = SCENE_LIGHT_SUN}, "light/sun.glsl",
                  "light_sun(LightSun(inputs[3 * i + 1].rgb, -normalize(inputs[3 * i + 2].xyz)))");
}

static struct timeline constant(double x, double y, double z)
{
    return (struct timeline){.component_count = 3, .value = {x, y, z}};
}

static void camera_pinhole_is_its_twin(void **state)
{
    static const char *const MODULES[] = {"camera/pinhole.glsl", NULL};
    enum { WIDTH = 320, HEIGHT = 180 };
    struct scene_camera camera = {.position = constant(1.0, -2.0, 3.0),
                                  .target = constant(0.25, 0.5, -1.0),
                                  .up = constant(0.2, 1.0, 0.1),
                                  .fov = {.component_count = 1, .value = {37.0}},
                                  .mirror = true};
    struct camera_pinhole_params params = {.position = {1.0, -2.0, 3.0},
                                           .target = {0.25, 0.5, -1.0},
                                           .up = {0.2, 1.0, 0.1},
                                           .fov_deg = 37.0,
                                           .width_px = WIDTH,
                                           .height_px = HEIGHT,
                                           .mirror = true};
    struct random random = {15};
    struct camera_pinhole twin;
    struct camera_view view;
    double corner[3], across[3], down[3];

    assert_true(camera_view_init(&view, &camera, 0.0, WIDTH, HEIGHT, NULL));
    for (int c = 0; c < 3; c++) {
        corner[c] = view.forward[c] - view.half_width * view.right[c] + view.half_height * view.up[c];
        across[c] = 2.0 * view.half_width / WIDTH * view.right[c];
        down[c] = -2.0 * view.half_height / HEIGHT * view.up[c];
    }
    put(COUNT, corner[0], corner[1], corner[2], 0.0);
    put(COUNT + 1, across[0], across[1], across[2], 0.0);
    put(COUNT + 2, down[0], down[1], down[2], 0.0);
    for (size_t i = 0; i < COUNT; i++) {
        put(i, random_between(&random, 0.0, WIDTH), random_between(&random, 0.0, HEIGHT), 0.0, 0.0);
    }
    probe(MODULES,
          "vec4 probe(int i) {\n"
          "    CameraPinhole camera = CameraPinhole(vec3(0.0), inputs[256].xyz, inputs[257].xyz, inputs[258].xyz);\n"
          "    return vec4(camera_pinhole_toward(camera, inputs[i].xy), 0.0);\n"
          "}\n",
          COUNT + 3);
    camera_pinhole_init(&twin, &params);
    for (size_t i = 0; i < COUNT; i++) {
        struct ray ray = camera_pinhole_ray(&twin, inputs[i][0], inputs[i][1]);
        struct vec3 toward = vec3_scale(ray.direction, 1.0 / vec3_dot(ray.direction, twin.forward));

        // The sum has three terms of size 1, each of two rounded factors.
        assert_near(outputs[i][0], toward.x, 8.0 * ROUNDING);
        assert_near(outputs[i][1], toward.y, 8.0 * ROUNDING);
        assert_near(outputs[i][2], toward.z, 8.0 * ROUNDING);
    }
}

static void segment_is_the_closed_form(void **state)
{
    static const char *const MODULES[] = {"math/spectrum_grey.glsl", "math/segment.glsl", NULL};

    // Optical depths go from 1e-8 to 100; 0 is one of them as well.
    for (size_t i = 0; i < COUNT; i++)
        put(i, i == 0 ? 0.0 : pow(10.0, -8.0 + 10.0 * (double)i / COUNT), 0.0, 0.0, 0.0);
    probe(MODULES,
          "vec4 probe(int i) {\n"
          "    Segment part = segment(inputs[i].x);\n"
          "    return vec4(part.transmittance, part.escape, 0.0, 0.0);\n"
          "}\n",
          COUNT);
    for (size_t i = 0; i < COUNT; i++) {
        double x = inputs[i][0];
        double escape = closed_form_emission_slab(1.0, x, 1.0, 0.0);

        // exp(-x) as exp2(-x log2 e) loses x roundings; the driver's exp2 is good to about 2^-20.
        assert_near(outputs[i][0], closed_form_transmittance(x, 1.0),
                    64.0 * ROUNDING * fmin(1.0, (1.0 + x) * exp(-x)) + 1e-37);
        assert_near(outputs[i][1], escape, 64.0 * ROUNDING * escape);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(phase_henyey_greenstein_is_its_twin),
        cmocka_unit_test(phase_isotropic_is_its_twin),
        cmocka_unit_test(density_fold_fractal_distance_is_its_twin),
        cmocka_unit_test(density_fold_fractal_at_is_its_twin),
        cmocka_unit_test(light_point_is_its_twin),
        cmocka_unit_test(light_point_even_is_its_twin),
        cmocka_unit_test(light_sun_is_its_twin),
        cmocka_unit_test(camera_pinhole_is_its_twin),
        cmocka_unit_test(segment_is_the_closed_form),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
