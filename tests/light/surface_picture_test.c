// Pictures of objects in closed form: depth, alpha, furnaces, counts of rays.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "tests/support/gl_stage.h"
#include "tests/support/object_job.h"
#include "tests/support/shader_dir.h"
#include "tests/support/shader_probe.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define OBJECTS(list) "\"objects\": [" list "]"
#define WHITE "\"background\": 1, "
#define DEEP                                                                                                           \
    "\"quality\": {\"method\": \"midpoint\", \"step\": 0.05, \"light_step\": 0.05, \"max_depth\": 32, "                \
    "\"min_throughput\": 1e-7}"
#define SAMPLES "\"quality\": {\"method\": \"midpoint\", \"step\": 0.05, \"light_step\": 0.05, \"samples\": 4}"

struct picture {
    struct image image;
    struct renderer_result result;
};

static bool try_to_render_on(enum gl_backend backend, struct picture *picture, const char *scene, const char *rest,
                             struct error *error)
{
    struct gl_stage stage = gl_stage_open(backend, test_shader_dir());
    struct job job;
    bool ok;

    object_job_parse(&job, scene, rest);
    ok = image_init(&picture->image, job.width_px, job.height_px, true, true, error) &&
         renderer_render(stage.renderer, &(struct renderer_frame){.job = &job, .frame = 0, .image = &picture->image},
                         &picture->result, error);
    gl_stage_close(stage);
    job_finish(&job);
    return ok;
}

static void render_on(enum gl_backend backend, struct picture *picture, const char *scene, const char *rest)
{
    struct error error = {{0}};

    if (!try_to_render_on(backend, picture, scene, rest, &error)) fail_msg("%s", error.message);
}

static void render(struct picture *picture, const char *scene, const char *rest)
{
    render_on(GL_BACKEND_SOFTWARE, picture, scene, rest);
}

static const float *rgba_at(const struct picture *picture, int x, int y)
{
    return picture->image.rgba + 4 * (y * picture->image.width_px + x);
}

static float depth_at(const struct picture *picture, int x, int y)
{
    return picture->image.depth[y * picture->image.width_px + x];
}

static float behind_at(const struct picture *picture, int x, int y)
{
    return picture->image.transmittance[4 * (y * picture->image.width_px + x)];
}

// Depth is measured along the camera's axis: the wall at z = 1 is 3 m away for every pixel.
static void depth_is_that_of_the_first_surface(void **state)
{
    struct picture picture;

    render(
        &picture,
        OBJECTS("{\"kind\": \"plane\", \"point\": [0, 0, -1], \"normal\": [0, 0, 1], \"material\": {" OBJECT_JOB_GREY
                "}}, {\"kind\": \"box\", \"center\": [0, 0, 0.5], \"size\": [1, 1, 1], \"material\": {" OBJECT_JOB_GLASS
                "}}"),
        SAMPLES);
    assert_float_equal(depth_at(&picture, 24, 16), 3, 1e-5);
    assert_float_equal(depth_at(&picture, 0, 0), 5, 1e-5);
    assert_float_equal(depth_at(&picture, 47, 31), 5, 1e-5);
    image_finish(&picture.image);
}

// Extinction of ln 2 a metre halves the light after a metre, in front of the wall or behind it.
static void a_medium_may_be_nearer_than_the_surface(void **state)
{
    static const char scene[] =
        "\"media\": [{\"density\": {\"kind\": \"homogeneous\"}, \"sigma_s\": 0, \"sigma_a\": 0.69314718}], "
        "\"objects\": [{\"kind\": \"plane\", \"point\": [0, 0, %g], \"normal\": [0, 0, 1], \"material\": {%s}}]";
    static const struct {
        double z, depth;
    } walls[] = {{3.5, 0.5}, {2, 1}};

    for (size_t i = 0; i < 2; ++i) {
        struct picture picture;
        char text[512];

        snprintf(text, sizeof text, scene, walls[i].z, OBJECT_JOB_MIRROR);
        render(&picture, text, OBJECT_JOB_QUALITY);
        assert_float_equal(depth_at(&picture, 24, 16), walls[i].depth, 1e-3);
        image_finish(&picture.image);
    }
}

// A mirror hides what is behind it; glass passes what its two boundaries do not reflect: (1 - F)^2 with F = 0.04.
static void alpha_is_what_comes_through_without_reflection(void **state)
{
    struct picture picture;

    render(&picture, OBJECTS(OBJECT_JOB_BALL(OBJECT_JOB_MIRROR)), OBJECT_JOB_QUALITY);
    assert_float_equal(rgba_at(&picture, 24, 16)[3], 1, 0);
    assert_float_equal(behind_at(&picture, 24, 16), 0, 0);
    assert_float_equal(rgba_at(&picture, 0, 0)[3], 0, 0);
    image_finish(&picture.image);
    render(&picture, OBJECTS(OBJECT_JOB_BALL(OBJECT_JOB_GLASS)), OBJECT_JOB_QUALITY);
    assert_float_equal(behind_at(&picture, 24, 16), 0.96 * 0.96, 1e-5);
    assert_float_equal(rgba_at(&picture, 24, 16)[3], 1 - 0.96 * 0.96, 1e-5);
    image_finish(&picture.image);
    render(&picture, OBJECTS(OBJECT_JOB_BALL(OBJECT_JOB_GLASS)), WHITE OBJECT_JOB_QUALITY);
    assert_float_equal(rgba_at(&picture, 24, 16)[3], 1, 0);
    assert_float_equal(behind_at(&picture, 24, 16), 0.96 * 0.96, 1e-5);
    image_finish(&picture.image);
}

static void nothing_is_seen_from_within_an_opaque_object(void **state)
{
    struct picture picture;

    render(
        &picture,
        OBJECTS("{\"kind\": \"sphere\", \"center\": [0, 0, 4], \"radius\": 1, \"material\": {" OBJECT_JOB_MIRROR "}}"),
        OBJECT_JOB_LIGHT ", " OBJECT_JOB_QUALITY);
    for (int y = 0; y < 32; y += 31) {
        assert_float_equal(rgba_at(&picture, 24, y)[0], 0, 0);
        assert_float_equal(rgba_at(&picture, 24, y)[3], 1, 0);
        assert_float_equal(behind_at(&picture, 24, y), 0, 0);
    }
    image_finish(&picture.image);
}

// Objects that absorb nothing are invisible in white surroundings, except for cut rays.
static void objects_that_absorb_nothing_vanish_in_a_furnace(void **state)
{
    static const char *const scenes[] = {
        OBJECTS(OBJECT_JOB_BALL(OBJECT_JOB_MIRROR)),
        OBJECTS(OBJECT_JOB_BALL(OBJECT_JOB_MIRROR ", \"roughness\": 0.4")),
        OBJECTS(OBJECT_JOB_BALL(OBJECT_JOB_GLASS)),
        OBJECTS(OBJECT_JOB_BALL(OBJECT_JOB_GLASS ", \"fresnel\": \"schlick\"")),
        OBJECTS(OBJECT_JOB_BALL("\"kind\": \"dielectric\", \"ior\": 0.7, \"fresnel\": \"none\"")),
        OBJECTS(OBJECT_JOB_BALL(OBJECT_JOB_GLASS ", \"roughness\": 0.1")),
        OBJECTS(
            OBJECT_JOB_BALL(OBJECT_JOB_GLASS) ", {\"kind\": \"box\", \"center\": [0.2, 0.1, 0], \"size\": [1, 1, 1],"
                                              " \"material\": {\"kind\": \"dielectric\", \"ior\": 2}}"),
    };
    static const enum gl_backend backends[] = {GL_BACKEND_SOFTWARE, GL_BACKEND_EGL};

    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; ++i)
        for (size_t k = 0; k < 2; ++k) {
            struct picture picture;
            double sum = 0, lost;

            render_on(backends[k], &picture, scenes[i], WHITE DEEP);
            for (size_t p = 0; p < 48 * 32; ++p) {
                float red = picture.image.rgba[4 * p];

                assert_true(red >= 0 && red <= 1.0001F);
                sum += red;
            }
            lost = 1 - sum / (48 * 32);
            print_message("scene %zu: lost %.2e, cut %.2e, %.2f rays a pixel\n", i, lost,
                          picture.result.ray_counts.cut_throughput, picture.result.ray_counts.rays);
            assert_float_equal(lost, picture.result.ray_counts.cut_throughput, 1e-5);
            image_finish(&picture.image);
        }
}

// Two mirrors face each other: every ray between them is cut in the end, with all of its throughput.
static void cut_rays_are_counted(void **state)
{
    struct picture picture;

    render(
        &picture,
        OBJECTS("{\"kind\": \"plane\", \"point\": [0, 0, -1], \"normal\": [0, 0, 1], \"material\": {\"kind\": "
                "\"mirror\", \"reflectance\": 0.5}},"
                " {\"kind\": \"plane\", \"point\": [0, 0, 5], \"normal\": [0, 0, -1], \"material\": {" OBJECT_JOB_MIRROR
                "}}"),
        WHITE "\"quality\": {\"method\": \"midpoint\", \"step\": 0.05, \"max_depth\": 5, \"min_throughput\": 0}");
    // Five reflections, three of them at 0.5, are followed; the sixth ray would have the same throughput.
    assert_float_equal(picture.result.ray_counts.rays, 6, 1e-6);
    assert_float_equal(picture.result.ray_counts.cut_rays, 1, 1e-6);
    assert_float_equal(picture.result.ray_counts.cut_throughput, 0.125, 1e-6);
    assert_float_equal(rgba_at(&picture, 24, 16)[0], 0, 0);
    image_finish(&picture.image);
    render(
        &picture,
        OBJECTS("{\"kind\": \"plane\", \"point\": [0, 0, -1], \"normal\": [0, 0, 1], \"material\": {\"kind\": "
                "\"mirror\", \"reflectance\": 0.5}},"
                " {\"kind\": \"plane\", \"point\": [0, 0, 5], \"normal\": [0, 0, -1], \"material\": {" OBJECT_JOB_MIRROR
                "}}"),
        WHITE "\"quality\": {\"method\": \"midpoint\", \"step\": 0.05, \"max_depth\": 32, \"min_throughput\": 0.2}");
    assert_float_equal(picture.result.ray_counts.rays, 5, 1e-6);
    assert_float_equal(picture.result.ray_counts.cut_throughput, 0.125, 1e-6);
    image_finish(&picture.image);
}

// The clip range ends media by the length of the path from the camera, here with a reflection in it; the wall stays.
static void the_clip_range_follows_the_path(void **state)
{
    struct picture picture;

    // The glow is 1 a metre, seen over the 100 m to which the camera is clipped.
    render(&picture,
           "\"media\": [{\"density\": {\"kind\": \"homogeneous\"}, \"sigma_s\": 0, \"sigma_a\": 0, \"emission\": "
           "1}], " OBJECTS(
               "{\"kind\": \"plane\", \"point\": [0, 0, 1], \"normal\": [0, 0, 1], \"material\": {" OBJECT_JOB_MIRROR
               "}}"),
           OBJECT_JOB_QUALITY);
    assert_float_equal(rgba_at(&picture, 24, 16)[0], 100, 0.1);
    image_finish(&picture.image);
}

// Mesa 22 ends a pixel's loops after 65,535 iterations, Mesa 25 runs them all.
static bool gl_runs_long_loops(void)
{
    const float wanted[1][4] = {{70000.0f}};
    float run[1][4];

    shader_probe_run(&(struct shader_probe_params){.modules = (const char *const[]){NULL},
                                                   .body = "vec4 probe(int index)\n{\n"
                                                           "    float x = 0.5, count = 0.0;\n"
                                                           "    while (count < inputs[0].x && x < 2.0) {\n"
                                                           "        x = fract(1.37 * x + 0.11);\n"
                                                           "        count += 1.0;\n"
                                                           "    }\n"
                                                           "    return vec4(count);\n}\n",
                                                   .inputs = wanted,
                                                   .input_count = 1,
                                                   .count = 1},
                     run);
    return run[0][0] == wanted[0][0];
}

// A ray of 33 segments with 2 lights and 1000 points takes more iterations than software GL runs. They are used up in
// the last segment, so that nothing after it could miss them.
static void a_ray_whose_last_loop_is_cut_fails_its_frame(void **state)
{
    struct error error = {{0}};
    struct picture picture;

    if (gl_runs_long_loops()) {
        print_message("this GL runs all iterations of long loops: nothing is cut\n");
        skip();
    }
    assert_false(try_to_render_on(
        GL_BACKEND_SOFTWARE, &picture,
        "\"media\": [{\"density\": {\"kind\": \"homogeneous\"}, \"sigma_s\": 1e-3, \"sigma_a\": 0}], " OBJECTS(
            "{\"kind\": \"plane\", \"point\": [0, 0, 3], \"normal\": [0, 0, 1], \"material\": {" OBJECT_JOB_MIRROR "}},"
            " {\"kind\": \"plane\", \"point\": [0, 0, 5], \"normal\": [0, 0, -1], \"material\": {" OBJECT_JOB_MIRROR
            "}}"),
        "\"lights\": [{\"kind\": \"point\", \"intensity\": 1, \"position\": [0, 1, 4]}, {\"kind\": \"point\","
        " \"intensity\": 1, \"position\": [0, -1, 4]}], \"quality\": {\"method\": \"equiangular\", \"points\": 1000,"
        " \"max_depth\": 32}",
        &error));
    assert_int_equal(picture.result.fault, RENDERER_FAULT_ENDLESS);
    assert_non_null(strstr(error.message, "iterations"));
    image_finish(&picture.image);
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(depth_is_that_of_the_first_surface),
        cmocka_unit_test(a_medium_may_be_nearer_than_the_surface),
        cmocka_unit_test(alpha_is_what_comes_through_without_reflection),
        cmocka_unit_test(nothing_is_seen_from_within_an_opaque_object),
        cmocka_unit_test(objects_that_absorb_nothing_vanish_in_a_furnace),
        cmocka_unit_test(cut_rays_are_counted),
        cmocka_unit_test(the_clip_range_follows_the_path),
        cmocka_unit_test(a_ray_whose_last_loop_is_cut_fails_its_frame),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
