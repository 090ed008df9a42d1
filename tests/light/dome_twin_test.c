// Shader modules of spheres and domes against their twins, and their random directions against the light.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "reference/dome.h"
#include "reference/sphere_light.h"
#include "tests/support/assert_near.h"
#include "tests/support/random.h"
#include "tests/support/shader_probe.h"
#include "worker/gl/gl_functions.h"
#include "worker/picture/image.h"
#include "worker/textures/dome_table.h"
#include "worker/textures/gl_texture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { COUNT = 256, WIDTH = 40, HEIGHT = 21, IMAGE_UNIT = 3, TABLE_UNIT = 4 };

static float inputs[2 * COUNT][4], outputs[COUNT][4], pixels[4 * WIDTH * HEIGHT], rgb[3 * WIDTH * HEIGHT];
static struct image picture = {.width_px = WIDTH, .height_px = HEIGHT, .rgba = pixels};
static unsigned textures[2];
static const struct gl_functions *gl_of_textures;

static void put_texture(const struct gl_functions *gl, const struct image *image, unsigned *texture, unsigned unit)
{
    struct error error = {{0}};

    if (!gl_texture_create(gl, image->width_px, image->height_px, texture, &error)) fail_msg("%s", error.message);
    gl_texture_fill(gl, *texture, image);
    gl->BindTextureUnit(unit, *texture);
}

static void bind(const struct gl_functions *gl, void *user)
{
    struct image table;

    assert_true(dome_table_init(&table, &picture, NULL));
    put_texture(gl, &picture, &textures[0], IMAGE_UNIT);
    put_texture(gl, &table, &textures[1], TABLE_UNIT);
    image_finish(&table);
    gl_of_textures = gl;
}

static void release(void *user)
{
    gl_of_textures->DeleteTextures(2, textures);
}

// `body` ends a function that returns a vec4, with `way` and `more`, the two inputs of i.
static void probe(const char *body)
{
    static const char *const MODULES[] = {"math/constants.glsl",      "math/arc.glsl",         "math/spectrum_rgb.glsl",
                                          "math/random.glsl",         "scatter/random.glsl",   "scatter/turn.glsl",
                                          "light/sample.glsl",        "light/sphere.glsl",     "light/dome_even.glsl",
                                          "light/dome_gradient.glsl", "light/dome_image.glsl", NULL};
    char text[2048];

    snprintf(text, sizeof text,
             "layout(binding = %d) uniform sampler2D image;\nlayout(binding = %d) uniform sampler2D table;\n"
             "const LightDomeImage dome = LightDomeImage(vec3(2.0, 1.0, 0.5), mat3(0.36, 0.48, -0.8, -0.8, 0.6, 0.0, "
             "0.48, 0.64, 0.6));\n"
             "vec4 probe(int i)\n{\n    vec4 way = inputs[2 * i], more = inputs[2 * i + 1];\n%s}\n",
             IMAGE_UNIT, TABLE_UNIT, body);
    shader_probe_run(&(struct shader_probe_params){.modules = MODULES,
                                                   .head = "const int random_stream = 0;\n",
                                                   .body = text,
                                                   .inputs = (const float(*)[4])inputs,
                                                   .input_count = 2 * COUNT,
                                                   .count = COUNT,
                                                   .bind = bind,
                                                   .release = release},
                     outputs);
}

static struct vec3 vector_of(const float value[4])
{
    return (struct vec3){value[0], value[1], value[2]};
}

static void put(size_t at, struct vec3 value, double w)
{
    inputs[at][0] = (float)value.x;
    inputs[at][1] = (float)value.y;
    inputs[at][2] = (float)value.z;
    inputs[at][3] = (float)w;
}

static struct vec3 random_direction(struct random *random)
{
    double y = random_between(random, -1.0, 1.0), turn = random_between(random, 0.0, 2.0 * M_PI);

    return (struct vec3){sqrt(1.0 - y * y) * sin(turn), y, sqrt(1.0 - y * y) * cos(turn)};
}

static void put_directions(void)
{
    struct random random = {71};

    for (size_t i = 0; i < COUNT; i++) {
        put(2 * i, random_direction(&random), 0.0);
        put(2 * i + 1, (struct vec3){random_between(&random, 0.0, 1.0), random_between(&random, 0.0, 1.0), 0.0}, 0.0);
    }
}

// Every texel has colours of its own; one is a sun.
static struct dome make_image(void)
{
    struct random random = {72};

    for (size_t i = 0; i < 4 * WIDTH * HEIGHT; i++)
        pixels[i] = (float)random_between(&random, 0.1, 1.0);
    for (size_t c = 0; c < 3; c++)
        pixels[4 * (6 * WIDTH + 31) + c] = 1e5F;
    for (size_t i = 0; i < 3 * WIDTH * HEIGHT; i++)
        rgb[i] = pixels[i / 3 * 4 + i % 3];
    return (struct dome){.kind = SCENE_DOME_FILE,
                         .along = {2.0, 1.0, 0.5},
                         .axis = {0.0, 1.0, 0.0},
                         .rgb = rgb,
                         .width = WIDTH,
                         .height = HEIGHT};
}

// The probe's matrix leads from the world into the image.
static struct vec3 turn(struct vec3 way)
{
    return (struct vec3){0.36 * way.x - 0.8 * way.y + 0.48 * way.z, 0.48 * way.x + 0.6 * way.y + 0.64 * way.z,
                         -0.8 * way.x + 0.6 * way.z};
}

static void gradient_is_its_twin(void **state)
{
    const struct dome dome = {
        .kind = SCENE_DOME_GRADIENT, .along = {3.0, 2.0, 0.1}, .against = {0.0, 1.0, 5.0}, .axis = {0.6, 0.0, -0.8}};

    put_directions();
    make_image();
    probe("    return vec4(light_dome_gradient_radiance(LightDomeGradient(vec3(3.0, 2.0, 0.1), vec3(0.0, 1.0, 5.0),\n"
          "                                                                vec3(0.6, 0.0, -0.8)), way.xyz), 0.0);\n");
    for (size_t i = 0; i < COUNT; i++) {
        double wanted[3];

        dome_radiance(&dome, vector_of(inputs[2 * i]), wanted);
        for (int c = 0; c < 3; c++)
            assert_near(outputs[i][c], wanted[c], 2e-6);
    }
}

static void image_is_its_twin(void **state)
{
    struct dome dome = make_image();

    put_directions();
    probe("    return vec4(light_dome_image_radiance(dome, image, way.xyz), 0.0);\n");
    for (size_t i = 0; i < COUNT; i++) {
        struct vec3 own = vec3_normalize(turn(vector_of(inputs[2 * i])));
        double wanted[3], near[3];

        dome_radiance(&dome, own, wanted);
        // An angle's rounding moves the place, near the sun by much light.
        dome_radiance(&dome, vec3_normalize(vec3_add(own, (struct vec3){3e-6, -2e-6, 3e-6})), near);
        for (int c = 0; c < 3; c++)
            assert_near(outputs[i][c], wanted[c], 2e-5 * wanted[c] + 3.0 * fabs(near[c] - wanted[c]) + 2e-5);
    }
}

// The mean of radiance over density is the integral of the radiance: of every channel, the sun included, and of what is
// left without it.
static void assert_integral(const char *weight, double wanted_of(const struct dome *dome, struct vec3 own, int channel))
{
    enum { STEPS = 1000 };
    struct dome dome = make_image();
    double sum[3] = {0.0}, squares[3] = {0.0}, wanted[3] = {0.0};
    char body[1024];

    put_directions();
    snprintf(body, sizeof body,
             "    vec3 sum = vec3(0.0);\n"
             "    for (int k = 0; k < 4096; ++k) {\n"
             "        walk_random_start(uvec2(i), uint(k), 0u, 5u);\n"
             "        vec2 rows = vec2(walk_random(), walk_random()), columns = vec2(walk_random(), walk_random());\n"
             "        vec3 drawn = light_dome_image_draw(dome, image, table, rows, columns, vec2(walk_random(), "
             "walk_random()));\n"
             "        vec3 radiance = light_dome_image_radiance(dome, image, drawn);\n"
             "        sum += %s / light_dome_image_density(dome, image, table, drawn);\n"
             "    }\n    return vec4(sum / 4096.0, 0.0);\n",
             weight);
    probe(body);
    for (int row = 0; row < STEPS; row++)
        for (int column = 0; column < 2 * STEPS; column++) {
            double up = M_PI * (0.5 - (row + 0.5) / STEPS), around = M_PI * ((column + 0.5) / STEPS - 1.0);
            struct vec3 own = {cos(up) * sin(around), sin(up), cos(up) * cos(around)};

            for (int c = 0; c < 3; c++)
                wanted[c] += wanted_of(&dome, own, c) * cos(up) * M_PI * M_PI / STEPS / STEPS;
        }
    for (size_t i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++) {
            sum[c] += outputs[i][c] / (double)COUNT;
            squares[c] += outputs[i][c] * outputs[i][c] / (double)COUNT;
        }
    for (int c = 0; c < 3; c++) {
        double error = sqrt((squares[c] - sum[c] * sum[c]) / COUNT);

        print_message("%g is wanted %g, error %.2g\n", sum[c], wanted[c], error / wanted[c]);
        assert_true(error < 0.02 * wanted[c]);
        assert_near(sum[c], wanted[c], 4.0 * error);
    }
}

static double whole(const struct dome *dome, struct vec3 own, int channel)
{
    double radiance[3];

    dome_radiance(dome, own, radiance);
    return radiance[channel];
}

static double small(const struct dome *dome, struct vec3 own, int channel)
{
    return fmin(whole(dome, own, channel), 3.0);
}

static void draws_bring_the_images_light(void **state)
{
    assert_integral("radiance", whole);
}

static void draws_bring_the_faint_lights_share(void **state)
{
    assert_integral("min(radiance, vec3(3.0))", small);
}

static void sphere_is_its_twin(void **state)
{
    static float distances[COUNT][4];
    struct random random = {73};

    for (size_t i = 0; i < COUNT; i++) {
        double away = i % 4 == 0 ? 0.2 : pow(10.0, random_between(&random, -3.0, 3.0));

        put(2 * i, vec3_scale(random_direction(&random), i % 4 == 0 ? away : 0.5 + away),
            random_between(&random, 0.0, 0.999));
        put(2 * i + 1, (struct vec3){random_between(&random, 0.0, 1.0), 0.0, 0.0}, 0.0);
    }
    probe(
        "    LightSample light = light_sphere(LightSphere(vec3(3.0), vec3(0.0), 0.5), way.xyz, vec2(way.w, more.x));\n"
        "    return vec4(light.direction, light.distance);\n");
    memcpy(distances, outputs, sizeof distances);
    probe(
        "    LightSample light = light_sphere(LightSphere(vec3(3.0), vec3(0.0), 0.5), way.xyz, vec2(way.w, more.x));\n"
        "    return vec4(light.irradiance.r);\n");
    for (size_t i = 0; i < COUNT; i++) {
        const struct sphere_light lamp = {.radius = 0.5};
        struct vec3 from = vector_of(inputs[2 * i]), way = vec3_normalize(vector_of(distances[i]));
        double wanted = sphere_light_solid_angle(&lamp, from) * 3.0 / (M_PI * 0.25), distance = vec3_length(from);
        // At a grazing place a distance's rounding is as the root of it.
        double met = sphere_light_distance(&lamp, &(struct ray){from, way});

        assert_near(outputs[i][0], wanted, 1e-5 * wanted + (distance < 0.51 ? 1e-3 : 0.0) * wanted);
        if (i % 4 == 0) assert_true(outputs[i][0] == 0.0F);
        if (i % 4 == 0 || !isfinite(met)) continue;
        assert_near(distances[i][3], met, 2e-3 * sqrt(distance) + 1e-5 * distance);
    }
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gradient_is_its_twin),         cmocka_unit_test(image_is_its_twin),
        cmocka_unit_test(draws_bring_the_images_light), cmocka_unit_test(draws_bring_the_faint_lights_share),
        cmocka_unit_test(sphere_is_its_twin),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // name pattern
    return cmocka_run_group_tests(tests, NULL, NULL);
}
