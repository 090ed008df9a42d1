// Scenes that lose nothing, in light that is 1 from everywhere: each pixel is 1 less what its cut rays would carry.
// SPDX-License-Identifier: Apache-2.0
#include "core/job/job.h"
#include "tests/support/assert_near.h"
#include "tests/support/studio.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#define SPHERE(x, y, z, radius, material)                                                                              \
    "{\"kind\": \"sphere\", \"center\": [" #x ", " #y ", " #z "], \"radius\": " #radius ", \"material\": {" material   \
    "}}"
#define BOX(x, y, z, a, b, c, material)                                                                                \
    "{\"kind\": \"box\", \"center\": [" #x ", " #y ", " #z "], \"size\": [" #a ", " #b ", " #c                         \
    "], \"material\": {" material "}}"
#define GLASS(ior) "\"kind\": \"dielectric\", \"ior\": " #ior
#define ROUGH(ior, roughness) GLASS(ior) ", \"roughness\": " #roughness
#define SCHLICK(ior, f0, f90) GLASS(ior) ", \"fresnel\": \"schlick\", \"f0\": " #f0 ", \"f90\": " #f90
#define NONE(ior) GLASS(ior) ", \"fresnel\": \"none\""
#define MIRROR "\"kind\": \"mirror\""
#define ROUGH_MIRROR(roughness) MIRROR ", \"roughness\": " #roughness
#define WHITE "\"kind\": \"diffuse\", \"albedo\": 1, \"specular\": 1, \"fresnel\": \"none\""
#define DEEP "\"method\": \"equiangular\", \"points\": 4, \"max_cut\": 1, \"max_depth\": 12, \"min_throughput\": 1e-4"
// The camera moves around the scene, then through it.
#define JOURNEY                                                                                                        \
    "\"position\": {\"keys\": [[0, [0.1, 0.2, 4]], [0.125, [3, 1, 2]], [0.25, [2, 3, -2]], [0.375, [-3, 0.7, -1]], "   \
    "[0.5, [0.3, 0.1, 0.4]], [0.625, [0.05, -0.1, -0.2]]]}, \"target\": {\"keys\": [[0, [0, 0, 0]], [0.4, [0.1, 0, "   \
    "0.05]], [0.625, [0.4, 0.3, -1]]]}"

// The journey's frames: all of them, those outside of everything, and those before the camera reaches the mirror.
enum { FRAMES = 16, FRAMES_OUTSIDE = 10, FRAMES_TO_MIRROR = 13 };

// Rounding error of floats over the dozen surfaces of a path.
static const double rounding = 1e-5;

static void assert_balance(const struct studio_picture *picture, int32_t frame)
{
    const struct ray_counts *counts = &picture->result.ray_counts;
    int count = picture->image.width_px * picture->image.height_px;
    double sum = 0.0;

    for (int i = 0; i < count; ++i) {
        const float *rgb = &picture->image.rgba[4 * i];
        double mean = ((double)rgb[0] + rgb[1] + rgb[2]) / 3.0;

        if (!(fmax(rgb[0], fmax(rgb[1], rgb[2])) <= 1.0 + rounding && mean >= 1.0 - counts->most_cut.value - rounding))
            fail_msg("frame %d: pixel %d is %.9g, %.9g, %.9g; at most %.9g are cut", (int)frame, i, rgb[0], rgb[1],
                     rgb[2], counts->most_cut.value);
        sum += mean;
    }
    assert_near(sum / count + counts->cut_throughput, 1.0, rounding);
}

static void assert_furnace_with(const char *objects, const char *quality, int32_t frames)
{
    const struct studio_scene scene = {.width_px = 12,
                                       .height_px = 8,
                                       .camera = {.fov = 60},
                                       .moving_camera = JOURNEY,
                                       .background = "1",
                                       .objects = objects,
                                       .quality = quality,
                                       .frames = "0-15"};
    struct studio_picture picture;
    struct job job = {0};
    double rays = 0.0;

    studio_parse(&job, &scene);
    for (int32_t frame = 0; frame < frames; ++frame) {
        studio_render(&job, frame, &picture);
        assert_balance(&picture, frame);
        rays += picture.result.ray_counts.rays;
        studio_finish(&picture);
    }
    job_finish(&job);
    // An empty scene would be as bright; it has one ray a pixel.
    assert_true(rays > 1.2 * frames);
}

static void assert_furnace(const char *objects)
{
    assert_furnace_with(objects, DEEP, FRAMES);
}

static void mirrors_keep_light(void **state)
{
    (void)state;
    assert_furnace_with(SPHERE(0, 0, 0, 1, MIRROR) ", " BOX(1, 1.2, 0, 1, 1, 1, MIRROR), DEEP, FRAMES_OUTSIDE);
}

static void rough_mirrors_keep_light(void **state)
{
    (void)state;
    assert_furnace_with(SPHERE(0, 0, 0, 1, ROUGH_MIRROR(0.5)) ", " BOX(1, 1.2, 0, 1, 1, 1, ROUGH_MIRROR(1)),
                        DEEP ", \"samples\": 4", FRAMES_OUTSIDE);
}

static void glass_keeps_light(void **state)
{
    studio_use(*(enum gl_backend *)*state);
    assert_furnace(SPHERE(0, 0, 0, 1, GLASS(1.5)));
}

static void glass_of_every_fresnel_keeps_light(void **state)
{
    (void)state;
    assert_furnace(SPHERE(0, 0, 0, 1, SCHLICK(1.4, 0.3, 0.7)) ", " BOX(1.2, 0.8, 0, 1, 1, 1, NONE(1.7)));
    assert_furnace(BOX(0, 0, 0, 1.5, 1, 1, "\"kind\": \"dielectric\", \"ior\": 0.7, \"fresnel\": \"schlick\""));
}

static void rough_glass_keeps_light(void **state)
{
    (void)state;
    assert_furnace_with(SPHERE(0, 0, 0, 1, ROUGH(1.5, 0.3)) ", " BOX(0.9, 1, 0, 1, 1, 1, ROUGH(1.3, 1)),
                        DEEP ", \"samples\": 4", FRAMES);
}

static void a_bubble_keeps_light(void **state)
{
    (void)state;
    assert_furnace(SPHERE(0, 0, 0, 1, GLASS(1.5)) ", " SPHERE(0.1, 0, 0, 0.7, GLASS(1)));
}

static void nested_glass_keeps_light(void **state)
{
    (void)state;
    assert_furnace(BOX(0, 0, 0, 2.4, 2, 2.2, GLASS(1.33)) ", " SPHERE(0, 0, 0, 0.9, GLASS(1.8)) ", " BOX(
        0.1, 0, 0, 0.5, 0.6, 0.7, GLASS(1.1)));
}

static void glass_that_overlaps_and_touches_keeps_light(void **state)
{
    (void)state;
    assert_furnace(BOX(-0.75, 0, 0, 1.5, 1, 1, GLASS(1.5)) ", " BOX(0.75, 0, 0, 1.5, 1, 1, GLASS(1.5)) ", " SPHERE(
        0.4, 0.6, 0.1, 0.5, GLASS(1.3)));
}

static void a_union_of_glass_keeps_light(void **state)
{
    (void)state;
    assert_furnace("{\"kind\": \"union\", \"material\": {" GLASS(
        1.5) "}, \"of\": [{\"kind\": \"sphere\", \"center\": [0, 0, "
             "0], \"radius\": 1}, {\"kind\": \"box\", \"center\": [0.9, 0, 0], \"size\": [1, 0.8, 0.6]}, {\"kind\": "
             "\"sphere\", \"center\": [-0.9, 0.2, 0], \"radius\": 0.6}]}");
}

static void glass_mirrors_and_gloss_keep_light(void **state)
{
    (void)state;
    assert_furnace_with("{\"kind\": \"plane\", \"point\": [0, -1, 0], \"material\": {" WHITE
                        "}}, " SPHERE(0, 0, 0, 1, GLASS(1.5)) ", " SPHERE(0.2, -0.7, 0.3, 0.5, MIRROR) ", " BOX(
                            -1.2, 0, 0, 1, 1.2, 1, GLASS(0.8)),
                        DEEP, FRAMES_TO_MIRROR);
}

static void a_mirror_in_glass_keeps_light(void **state)
{
    (void)state;
    assert_furnace_with(
        SPHERE(0, 0, 0, 1, GLASS(1.5)) ", " SPHERE(0.2, 0.1, -0.1, 0.4, MIRROR) ", " SPHERE(-0.5, 0.3, 0.1, 0.4, WHITE),
        DEEP, FRAMES_OUTSIDE);
}

// A medium that glows as it absorbs is in balance with the light around it, along refracted paths too.
static void glowing_glass_is_in_balance(void **state)
{
    static const char objects[] =
        SPHERE(0, 0, 0, 1, GLASS(1.5) ", \"interior\": {\"sigma_a\": [0.5, 2, 9], \"emission\": [0.5, 2, 9]}") ", " BOX(
            0.7, 0.5, 0, 1, 1, 1, GLASS(1.2) ", \"interior\": {\"sigma_a\": 3, \"emission\": 3}");

    (void)state;
    assert_furnace(objects);
    assert_furnace_with(objects,
                        "\"method\": \"midpoint\", \"step\": 0.1, \"max_cut\": 1, \"max_depth\": 12, "
                        "\"min_throughput\": 1e-4",
                        FRAMES);
}

// The throughput that a shallow limit cuts is counted exactly, pixel by pixel.
static void cut_rays_are_what_is_missing(void **state)
{
    struct studio_scene scene = {.width_px = 1,
                                 .height_px = 1,
                                 .camera = {.fov = 10},
                                 .moving_camera = JOURNEY,
                                 .background = "1",
                                 .objects = SPHERE(0, 0, 0, 1, GLASS(1.5)) ", " SPHERE(0.2, 0.1, -0.1, 0.4, MIRROR),
                                 .frames = "0-15"};
    static const char *const qualities[] = {
        "\"method\": \"equiangular\", \"points\": 4, \"max_cut\": 1, \"max_depth\": 1, \"min_throughput\": 0",
        "\"method\": \"equiangular\", \"points\": 4, \"max_cut\": 1, \"max_depth\": 4, \"min_throughput\": 1e-6",
        "\"method\": \"equiangular\", \"points\": 4, \"max_cut\": 1, \"max_depth\": 32, \"min_throughput\": 0.05"};

    (void)state;
    for (size_t i = 0; i < 3; ++i) {
        double cut = 0.0;
        struct job job = {0};

        scene.quality = qualities[i];
        studio_parse(&job, &scene);
        for (int32_t frame = 0; frame < FRAMES_TO_MIRROR; ++frame) {
            struct studio_picture picture;

            studio_render(&job, frame, &picture);
            assert_near(picture.image.rgba[0] + picture.result.ray_counts.cut_throughput, 1.0, rounding);
            cut += picture.result.ray_counts.cut_throughput;
            studio_finish(&picture);
        }
        assert_true(cut > 0.01);
        job_finish(&job);
    }
}

int main(int argument_count, char **arguments)
{
    static enum gl_backend software = GL_BACKEND_SOFTWARE, egl = GL_BACKEND_EGL;
    const struct CMUnitTest tests[] = {
        {"glass_keeps_light_egl", glass_keeps_light, NULL, NULL, &egl},
        {"glass_keeps_light_software", glass_keeps_light, NULL, NULL, &software},
        cmocka_unit_test(mirrors_keep_light),
        cmocka_unit_test(rough_mirrors_keep_light),
        cmocka_unit_test(glass_of_every_fresnel_keeps_light),
        cmocka_unit_test(rough_glass_keeps_light),
        cmocka_unit_test(a_bubble_keeps_light),
        cmocka_unit_test(nested_glass_keeps_light),
        cmocka_unit_test(glass_that_overlaps_and_touches_keeps_light),
        cmocka_unit_test(a_union_of_glass_keeps_light),
        cmocka_unit_test(glass_mirrors_and_gloss_keep_light),
        cmocka_unit_test(a_mirror_in_glass_keeps_light),
        cmocka_unit_test(glowing_glass_is_in_balance),
        cmocka_unit_test(cut_rays_are_what_is_missing),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, studio_close);
}
