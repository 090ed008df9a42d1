// Shader modules of textures against double precision, and against what a viewer outside must see.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "reference/vec3.h"
#include "tests/support/assert_near.h"
#include "tests/support/random.h"
#include "tests/support/shader_probe.h"
#include "worker/gl/gl_functions.h"
#include "worker/picture/image.h"
#include "worker/textures/gl_texture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { COUNT = 480, PIXEL_LIMIT = 64 * 64 };

static const double PI = 3.14159265358979323846;

static const char *const MODULES[] = {"texture/tile.glsl",  "texture/linear.glsl", "texture/nearest.glsl",
                                      "texture/plane.glsl", "texture/sphere.glsl", NULL};

static const char LOOKUP[] =
    "layout(binding = 32) uniform sampler2D image;\n"
    "vec4 probe(int i)\n{\n"
    "    vec2 uv = inputs[i].xy;\n"
    "    vec3 texel = inputs[i].z > 0.5 ? texture_nearest(image, uv) : texture_linear(image, uv);\n"
    "    return vec4(texel, 0.0);\n}\n";

static float pixels[4 * PIXEL_LIMIT];
static struct image picture = {.rgba = pixels};
static unsigned texture;
static const struct gl_functions *gl_of_texture;
static bool on_egl;
static float inputs[SHADER_PROBE_INPUT_LIMIT][4], outputs[COUNT][4];

static void bind(const struct gl_functions *gl, void *user)
{
    struct error error = {{0}};

    if (!gl_texture_create(gl, picture.width_px, picture.height_px, &texture, &error)) fail_msg("%s", error.message);
    gl_texture_fill(gl, texture, &picture);
    gl_of_texture = gl;
    gl->BindTextureUnit(32, texture);
}

static void release(void *user)
{
    gl_of_texture->DeleteTextures(1, &texture);
}

static void probe(const char *body, size_t input_count, size_t count)
{
    shader_probe_run(&(struct shader_probe_params){.modules = MODULES,
                                                   .body = body,
                                                   .inputs = (const float(*)[4])inputs,
                                                   .input_count = input_count,
                                                   .count = count,
                                                   .on_egl = on_egl,
                                                   .bind = bind,
                                                   .release = release},
                     outputs);
}

static void make_picture(int width, int height, struct random *random)
{
    picture.width_px = width;
    picture.height_px = height;
    for (int i = 0; i < 4 * width * height; i++)
        pixels[i] = (float)random_between(random, 0, 1);
}

// The quarters are red (top left), green (top right), blue (bottom left) and white, so that mirroring or turning shows.
static void make_quarters(void)
{
    static const float quarters[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};

    picture.width_px = 8;
    picture.height_px = 4;
    for (int y = 0; y < 4; y++)
        for (int x = 0; x < 8; x++)
            memcpy(pixels + (size_t)(4 * (8 * y + x)), quarters[y / 2 * 2 + x / 4], sizeof quarters[0]);
}

static long wrap(double at, int size)
{
    return (long)(at - size * floor(at / size));
}

static double pixel_at(double x, double y, int channel)
{
    long column = wrap(x, picture.width_px), row = wrap(y, picture.height_px);

    return pixels[4 * (row * picture.width_px + column) + channel];
}

// The position in the endless wall of tiles, in pixels from the top left corner of a tile.
static void find_position(const float uv[2], double *x, double *y)
{
    *x = (double)uv[0] * picture.width_px;
    *y = (1 - (double)uv[1]) * picture.height_px;
}

static double nearest(const float uv[2], int channel)
{
    double x, y;

    find_position(uv, &x, &y);
    return pixel_at(floor(x), floor(y), channel);
}

static double linear(const float uv[2], int channel)
{
    double x, y, sum = 0;

    find_position(uv, &x, &y);
    for (int j = 0; j < 2; j++)
        for (int i = 0; i < 2; i++) {
            double column = floor(x - 0.5) + i, row = floor(y - 0.5) + j;

            sum += (1 - fabs(x - 0.5 - column)) * (1 - fabs(y - 0.5 - row)) * pixel_at(column, row, channel);
        }
    return sum;
}

static bool is_near_an_edge(const float uv[2])
{
    double x, y;

    find_position(uv, &x, &y);
    return fabs(x - round(x)) < 1e-4 || fabs(y - round(y)) < 1e-4;
}

// Half of the points are for either filter; some lie on texels' centres, borders and corners of tiles.
static void put_points(struct random *random, double extent)
{
    for (size_t i = 0; i < COUNT; i++) {
        for (int c = 0; c < 2; c++) {
            double size = c ? picture.height_px : picture.width_px;
            double at = random_between(random, -extent, extent);

            if (i % 5 == 1) at = (floor(at * size) + 0.5) / size;
            if (i % 5 == 2) at = floor(at * size) / size;
            if (i % 5 == 3) at = floor(at);
            inputs[i][c] = (float)at;
        }
        inputs[i][2] = i % 2 ? 1 : 0;
    }
    inputs[0][0] = inputs[0][1] = -1e-12f; // so near below 0 that the position in the tile rounds to 1
}

// A position in the tile is rounded to 2^-24 of it; the result amplifies that by the number of texels of the side.
static void check_points(void)
{
    double tolerance = 3 * 0x1p-24 * (picture.width_px + picture.height_px) + 4 * 0x1p-24;

    for (size_t i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++)
            if (inputs[i][2] < 0.5f)
                assert_near(outputs[i][c], linear(inputs[i], c), tolerance);
            else if (!is_near_an_edge(inputs[i]))
                assert_near(outputs[i][c], nearest(inputs[i], c), 0);
}

static void lookups_are_their_twins(void **state)
{
    static const int sizes[][2] = {{1, 1}, {2, 1}, {1, 3}, {5, 3}, {16, 64}, {64, 64}};
    struct random random = {11};

    for (size_t i = 0; i < 2 * sizeof sizes / sizeof sizes[0]; i++) {
        on_egl = i % 2;
        make_picture(sizes[i / 2][0], sizes[i / 2][1], &random);
        put_points(&random, 3);
        probe(LOOKUP, COUNT, COUNT);
        check_points();
    }
    on_egl = false;
}

// Coordinates far away lose digits themselves; the lookup adds no error.
static void far_tiles_are_sampled_as_near_ones(void **state)
{
    struct random random = {12};

    make_picture(5, 3, &random);
    put_points(&random, 1e4);
    probe(LOOKUP, COUNT, COUNT);
    check_points();
}

// Coordinates, however large, give a texel of the image, never NaN.
static void huge_coordinates_stay_in_the_image(void **state)
{
    static const float values[] = {1e9f, -1e9f, 1e18f, -1e18f, 3e38f, -3e38f, 8388607.5f, -8388607.5f};
    struct random random = {13};

    make_picture(5, 3, &random);
    for (size_t i = 0; i < 16; i++) {
        inputs[i][0] = values[i / 2];
        inputs[i][1] = values[7 - i / 2];
        inputs[i][2] = i % 2 ? 1 : 0;
    }
    probe(LOOKUP, 16, 16);
    for (size_t i = 0; i < 16; i++)
        for (int c = 0; c < 3; c++)
            assert_true(outputs[i][c] >= 0 && outputs[i][c] <= 1);
}

static void put_vector(float *input, struct vec3 vector)
{
    input[0] = (float)vector.x;
    input[1] = (float)vector.y;
    input[2] = (float)vector.z;
}

static struct vec3 random_unit(struct random *random)
{
    struct vec3 way = {random_between(random, -1, 1), random_between(random, -1, 1), random_between(random, -1, 1)};

    return vec3_normalize(way);
}

// The mapping is that of core/scene/scene.h.
static void plane_uv(struct vec3 offset, struct vec3 normal, const double size[2], double uv[2])
{
    struct vec3 upright = fabs(normal.y) > 0.999 ? (struct vec3){0, 0, -1} : (struct vec3){0, 1, 0};
    struct vec3 across = vec3_normalize(vec3_cross(upright, normal));

    uv[0] = 0.5 + vec3_dot(offset, across) / size[0];
    uv[1] = 0.5 + vec3_dot(offset, vec3_cross(normal, across)) / size[1];
}

static const char PLANE[] =
    "vec4 probe(int i)\n{\n"
    "    return vec4(texture_plane_uv(inputs[2 * i].xyz, inputs[2 * i + 1].xyz,\n"
    "                                 vec2(inputs[2 * i].w, inputs[2 * i + 1].w)), 0.0, 0.0);\n}\n";

// A float is exact to a millimetre at 10 km: tiles are off by that, and by three such roundings.
static void planes_are_their_twins(void **state)
{
    static const double reaches[] = {1, 100, 1e4};
    struct random random = {17};

    for (size_t k = 0; k < 3; k++) {
        double extent = reaches[k], worst = 0;

        for (size_t i = 0; i < COUNT; i++) {
            struct vec3 normal = i % 4 ? random_unit(&random) : (struct vec3){0, i % 8 ? 1 : -1, 0};

            put_vector(inputs[2 * i], vec3_scale(random_unit(&random), extent));
            put_vector(inputs[2 * i + 1], normal);
            inputs[2 * i][3] = (float)random_between(&random, 0.5, 2);
            inputs[2 * i + 1][3] = (float)random_between(&random, 0.5, 2);
        }
        probe(PLANE, 2 * COUNT, COUNT);
        for (size_t i = 0; i < COUNT; i++) {
            const float *offset = inputs[2 * i], *normal = inputs[2 * i + 1];
            double uv[2], size[2] = {offset[3], normal[3]};

            if (fabs(fabs((double)normal[1]) - 0.999) < 1e-6) continue;
            plane_uv((struct vec3){offset[0], offset[1], offset[2]}, (struct vec3){normal[0], normal[1], normal[2]},
                     size, uv);
            for (int c = 0; c < 2; c++)
                worst = fmax(worst, fabs((double)outputs[i][c] - uv[c]) * size[c]);
        }
        print_message("tiles %g m away: off by %.2g m at most\n", extent, worst);
        // The length of `across` is computed from one that may be as small as 0.045.
        assert_true(worst < 4e-7 * (extent + 1));
    }
}

// The viewer looks along -normal; the directions right and up are those of a camera.
static void assert_plane_is_seen(struct vec3 normal, struct vec3 camera_up)
{
    static const char body[] = "layout(binding = 32) uniform sampler2D image;\n"
                               "vec4 probe(int i)\n{\n"
                               "    vec2 uv = texture_plane_uv(inputs[i + 1].xyz, inputs[0].xyz, vec2(2.0, 1.0));\n"
                               "    return vec4(texture_nearest(image, uv), 0.0);\n}\n";
    static const double places[4][2] = {{-0.5, 0.25}, {0.5, 0.25}, {-0.5, -0.25}, {0.5, -0.25}};
    struct vec3 right = vec3_normalize(vec3_cross(vec3_scale(normal, -1), camera_up));
    struct vec3 up = vec3_cross(right, vec3_scale(normal, -1));

    make_quarters();
    put_vector(inputs[0], normal);
    for (size_t i = 0; i < 4; i++)
        put_vector(inputs[i + 1], vec3_add(vec3_scale(right, places[i][0]), vec3_scale(up, places[i][1])));
    probe(body, 5, 4);
    for (size_t i = 0; i < 4; i++) // the middles of the quarters, in the order of their colours
        for (int c = 0; c < 3; c++)
            assert_near(outputs[i][c], i == 3 || (int)i == c ? 1 : 0, 0);
}

static void planes_and_boxes_are_seen_upright_from_outside(void **state)
{
    const struct vec3 up = {0, 1, 0}, away = {0, 0, -1};

    assert_plane_is_seen((struct vec3){0, 0, 1}, up);
    assert_plane_is_seen((struct vec3){0, 0, -1}, up);
    assert_plane_is_seen((struct vec3){1, 0, 0}, up);
    assert_plane_is_seen((struct vec3){-1, 0, 0}, up);
    assert_plane_is_seen((struct vec3){0, 1, 0}, away);
    assert_plane_is_seen((struct vec3){0, -1, 0}, away);
    assert_plane_is_seen(vec3_normalize((struct vec3){0, 1, 1}), up);
    assert_plane_is_seen(vec3_normalize((struct vec3){-1, -1, 0.3}), up);
    assert_plane_is_seen(vec3_normalize((struct vec3){0.6, 0.9, -2}), up);
}

// The image laid over a wall equals the image, texel by texel.
static void wall_shows_the_image(void **state)
{
    static const char body[] = "layout(binding = 32) uniform sampler2D image;\n"
                               "vec4 probe(int i)\n{\n"
                               "    vec3 offset = vec3(float(i % 5) - 2.0, 1.0 - float(i / 5), 0.0);\n"
                               "    vec2 uv = texture_plane_uv(offset, vec3(0.0, 0.0, 1.0), vec2(5.0, 3.0));\n"
                               "    return vec4(texture_linear(image, uv), 0.0);\n}\n";
    struct random random = {19};

    make_picture(5, 3, &random);
    probe(body, 1, 15);
    for (size_t i = 0; i < 15; i++)
        for (int c = 0; c < 3; c++)
            assert_near(outputs[i][c], pixels[4 * i + (size_t)c], 2e-6);
}

static const char SPHERE[] = "vec4 probe(int i)\n{\n    return vec4(texture_sphere_uv(inputs[i].xyz), 0.0, 0.0);\n}\n";

// GLSL promises few digits of its own arc tangent; the module's has nearly all.
static void spheres_are_their_twins(void **state)
{
    struct random random = {23};
    double worst = 0;

    for (size_t i = 0; i < COUNT; i++) {
        struct vec3 normal = random_unit(&random);

        if (i % 6 == 0) normal = vec3_normalize((struct vec3){normal.x * 1e-3, normal.y < 0 ? -1 : 1, normal.z * 1e-3});
        if (i % 6 == 1)
            normal = vec3_normalize((struct vec3){normal.x * 1e-3, normal.y, -1}); // where the image's ends meet
        if (i % 6 == 2) normal = vec3_normalize((struct vec3){normal.x, normal.y, 1e-6 * normal.z});
        put_vector(inputs[i], normal);
    }
    probe(SPHERE, COUNT, COUNT);
    for (size_t i = 0; i < COUNT; i++) {
        double x = inputs[i][0], y = inputs[i][1], z = inputs[i][2];
        double u = 0.5 + atan2(x, z) / (2 * PI), v = 0.5 + atan2(y, hypot(x, z)) / PI;

        worst = fmax(worst, fmax(fabs((double)outputs[i][0] - u), fabs((double)outputs[i][1] - v)));
    }
    print_message("places on a sphere: %.2g of the image's width beside their place at most\n", worst);
    assert_true(worst < 1e-6);
}

static void poles_and_the_seam_are_not_nan(void **state)
{
    static const struct vec3 normals[] = {{0, 1, 0},     {0, -1, 0},        {0, 0, -1},
                                          {-0.0, 0, -1}, {1e-30, 1, 1e-30}, {0, 1.0000001, 0}};

    for (size_t i = 0; i < 6; i++)
        put_vector(inputs[i], normals[i]);
    probe(SPHERE, 6, 6);
    for (size_t i = 0; i < 6; i++)
        for (int c = 0; c < 2; c++)
            assert_true(outputs[i][c] >= -1e-6f && outputs[i][c] <= 1.000001f);
    assert_near(outputs[0][1], 1, 1e-6);
    assert_near(outputs[1][1], 0, 1e-6);
    assert_near(outputs[2][0] * (1 - outputs[2][0]), 0, 1e-6);
}

// A step to the viewer's right is right in the image and a step up is up, from every side. The middle of the image
// faces +z.
static void spheres_are_seen_upright_from_outside(void **state)
{
    const struct vec3 up = {0, 1, 0};
    const double step = 0.01;
    struct random random = {29};

    put_vector(inputs[0], (struct vec3){0, 0, 1});
    for (size_t i = 1; i < COUNT / 3; i++) {
        struct vec3 normal = random_unit(&random), right, rise;

        if (fabs(normal.y) > 0.95 || (normal.z < 0 && fabs(normal.x) < 0.05)) normal = (struct vec3){0.6, 0, 0.8};
        right = vec3_normalize(vec3_cross(vec3_scale(normal, -1), up));
        rise = vec3_cross(right, vec3_scale(normal, -1));
        put_vector(inputs[3 * i], normal);
        put_vector(inputs[3 * i + 1], vec3_normalize(vec3_add(normal, vec3_scale(right, step))));
        put_vector(inputs[3 * i + 2], vec3_normalize(vec3_add(normal, vec3_scale(rise, step))));
    }
    probe(SPHERE, COUNT, COUNT);
    assert_near(outputs[0][0], 0.5, 1e-7);
    assert_near(outputs[0][1], 0.5, 1e-7);
    for (size_t i = 1; i < COUNT / 3; i++) {
        const float *at = outputs[3 * i], *right = outputs[3 * i + 1], *rise = outputs[3 * i + 2];

        assert_true(right[0] - at[0] > 0.9 * step / (2 * PI) && right[0] - at[0] < 4 * step / (2 * PI));
        assert_near(rise[1] - at[1], step / PI, 0.01 * step);
    }
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lookups_are_their_twins),
        cmocka_unit_test(far_tiles_are_sampled_as_near_ones),
        cmocka_unit_test(huge_coordinates_stay_in_the_image),
        cmocka_unit_test(planes_are_their_twins),
        cmocka_unit_test(planes_and_boxes_are_seen_upright_from_outside),
        cmocka_unit_test(wall_shows_the_image),
        cmocka_unit_test(spheres_are_their_twins),
        cmocka_unit_test(poles_and_the_seam_are_not_nan),
        cmocka_unit_test(spheres_are_seen_upright_from_outside),
    };

    make_quarters();                               // for tests that sample no image
    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
