// Objects, and media in and around them, against the reference: light, alpha, depth and the statistics of rays.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/assert_near.h"
#include "tests/support/render_frame.h"
#include "tests/support/true_light.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

// STRAY_LIMIT pixels of a picture may see the other side of an edge, by rounding.
enum { WIDTH_PX = 24, HEIGHT_PX = 16, STRAY_LIMIT = 4 };

#define LAMP "{\"kind\": \"point\", \"intensity\": [9, 8, 7], \"position\": [1.4, 2.1, 0.8]}"
#define SUN "{\"kind\": \"sun\", \"intensity\": [0.5, 1, 2], \"direction\": [1, -2, 0.5]}"
#define FLOOR(MORE)                                                                                                    \
    "{\"kind\": \"plane\", \"point\": [0, -1, 0], \"material\": {\"kind\": \"diffuse\", \"albedo\": [0.8, 0.6, 0.3]"   \
    "" MORE "}}"
#define BALL(MATERIAL)                                                                                                 \
    "{\"kind\": \"sphere\", \"center\": [0.1, 0, -0.2], \"radius\": 0.9, \"material\": {" MATERIAL "}}"
#define CORE(MATERIAL)                                                                                                 \
    "{\"kind\": \"sphere\", \"center\": [0.3, 0.1, 0], \"radius\": 0.4, \"material\": {" MATERIAL "}}"
#define PAIR(MATERIAL)                                                                                                 \
    "{\"kind\": \"union\", \"of\": [{\"kind\": \"sphere\", \"center\": [-0.5, -0.2, 0.3], \"radius\": 0.6},"           \
    " {\"kind\": \"box\", \"center\": [-0.2, -0.6, 0.4], \"size\": [1, 0.6, 0.7]}], \"material\": {" MATERIAL "}}"
#define GLASS "\"kind\": \"dielectric\", \"ior\": 1.5"
#define FOG "{\"density\": {\"kind\": \"homogeneous\"}, \"sigma_s\": [0.05, 0.04, 0.03], \"sigma_a\": 0.01}"
#define SMOKE                                                                                                          \
    ", \"interior\": {\"density\": {\"kind\": \"noise\", \"frequency\": 2, \"octaves\": 2}, \"sigma_s\": [2, 1.5, 1]," \
    " \"phase\": [{\"g\": 0.4}]}"
#define MIDPOINT "\"method\": \"midpoint\", \"step\": 0.05, \"light_step\": 0.05"
#define EQUIANGULAR "\"method\": \"equiangular\", \"points\": 100"

struct view {
    const char *position, *lights, *media, *objects, *quality;
};

static void parse(struct job *job, const struct view *view)
{
    struct error error = {{0}};
    char text[4096];

    snprintf(text, sizeof text,
             "{\"version\": 1, \"name\": \"objects\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [%d, %d],"
             " \"camera\": {\"position\": %s, \"target\": [0.05, -0.1, 0], \"up\": [0.1, 1, 0], \"fov\": 40,"
             " \"clip\": [0, 9]}, \"lights\": [%s], \"background\": [0.1, 0.2, 0.3],"
             " \"scene\": {\"media\": [%s], \"objects\": [%s]},"
             " \"quality\": {%s, \"max_depth\": 5, \"min_throughput\": 0.001, \"max_cut\": 1},"
             " \"output\": {\"path\": \"objects.####.exr\", \"aovs\": [\"Z\", \"transmittance\"]}}",
             WIDTH_PX, HEIGHT_PX, view->position ? view->position : "[0.4, 0.9, 3.6]", view->lights,
             view->media ? view->media : "", view->objects, view->quality ? view->quality : EQUIANGULAR);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

// Stray pixels may follow, or cut, a few rays more or less.
static void assert_same_rays(const struct true_light *light)
{
    double strays = (double)STRAY_LIMIT / (WIDTH_PX * HEIGHT_PX);

    assert_near(light->rays_seen.count, light->rays_true.count, 8.0 * strays);
    assert_near(light->rays_seen.cut_count, light->rays_true.cut_count, 8.0 * strays);
    assert_near(light->rays_seen.cut_throughput, light->rays_true.cut_throughput, strays);
    assert_near(light->rays_seen.cut_by_depth, light->rays_true.cut_by_depth, strays);
}

static void assert_true_objects(const struct view *view, double tolerance)
{
    struct true_light light;
    struct job job;

    parse(&job, view);
    light = true_light_compare_but(&job, GL_BACKEND_SOFTWARE, STRAY_LIMIT);
    assert_true(true_light_is_within(&light, tolerance));
    assert_true(light.depth.relative_rmse <= tolerance);
    assert_same_rays(&light);
    job_finish(&job);
}

// Nothing is marched: errors are roundings, which balls magnify.
static const double SURFACES = 2e-6;
// The error of points and steps, mostly where a shadow begins or ends between two of them.
static const double MEDIA = 3e-4;

static void a_glass_ball_on_a_floor(void **state)
{
    assert_true_objects(&(struct view){.lights = LAMP ", " SUN, .objects = FLOOR("") ", " BALL(GLASS)}, SURFACES);
    assert_true_objects(
        &(struct view){.lights = LAMP,
                       .objects = FLOOR(", \"specular\": 0.5") ", " BALL(GLASS ", \"fresnel\": \"schlick\"")},
        SURFACES);
}

static void mirrors_and_unions_of_mirrors(void **state)
{
    assert_true_objects(
        &(struct view){.lights = LAMP,
                       .objects = FLOOR("") ", " BALL("\"kind\": \"mirror\", \"reflectance\": [0.9, 0.8, "
                                                      "0.7]") ", " PAIR("\"kind\": \"mirror\"")},
        SURFACES);
}

static void later_objects_in_earlier_ones(void **state)
{
    static const char *const CORES[] = {CORE("\"kind\": \"dielectric\", \"ior\": 1"),
                                        CORE("\"kind\": \"dielectric\", \"ior\": 1.3"), CORE("\"kind\": \"mirror\""),
                                        CORE("\"kind\": \"diffuse\", \"albedo\": [0.2, 0.5, 0.9]")};

    for (size_t i = 0; i < sizeof CORES / sizeof *CORES; ++i) {
        char objects[2048];

        snprintf(objects, sizeof objects, "%s, %s, %s",
                 FLOOR("") ", " BALL(GLASS ", \"interior\": {\"sigma_a\": [0.8, 0.1, 0.3]}"), CORES[i],
                 PAIR(GLASS ", \"fresnel\": \"none\""));
        assert_true_objects(&(struct view){.lights = SUN ", " LAMP, .objects = objects}, SURFACES);
    }
}

#define STONES(FIRST, MATERIAL, LAST)                                                                                  \
    FIRST "{\"kind\": \"box\", \"center\": [-0.3, -0.7, 0], \"size\": [1.2, 0.6, 0.8], \"material\": {" MATERIAL       \
          "}}, {\"kind\": \"sphere\", \"center\": [0.9, -0.5, 0.2], \"radius\": 0.5, \"material\": {" MATERIAL         \
          "}}, {\"kind\": \"box\", \"center\": [-0.3, -0.2, 0], \"size\": [0.7, 0.4, 0.5], \"material\": {" GLASS      \
          "}}, {\"kind\": \"box\", \"center\": [-0.3, -0.7, 0.6], \"size\": [0.7, 0.4, 0.4], \"material\":"            \
          " {\"kind\": \"dielectric\", \"ior\": 1.3}}" LAST

// A block and a ball lie on the floor, other blocks on the first one and at its side. Coinciding faces are one
// boundary.
static void objects_that_touch(void **state)
{
    static const char *const OBJECTS[] = {STONES(FLOOR("") ", ", GLASS, ""), STONES("", GLASS, ", " FLOOR("")),
                                          STONES("", "\"kind\": \"mirror\"", ", " FLOOR("")),
                                          STONES(FLOOR("") ", ", "\"kind\": \"diffuse\", \"albedo\": 0.5", "")};

    for (size_t i = 0; i < sizeof OBJECTS / sizeof *OBJECTS; ++i)
        assert_true_objects(&(struct view){.lights = SUN ", " LAMP, .objects = OBJECTS[i]}, SURFACES);
}

static void seen_from_within(void **state)
{
    static const char *const POSITIONS[] = {"[0.2, 0.1, 0.3]", "[0.35, 0.15, 0.05]", "[0.4, -1.5, 1]"};

    for (size_t i = 0; i < sizeof POSITIONS / sizeof *POSITIONS; ++i)
        assert_true_objects(
            &(struct view){.position = POSITIONS[i],
                           .lights = LAMP,
                           .objects = FLOOR("") ", " BALL(GLASS) ", " CORE("\"kind\": \"dielectric\", \"ior\": 1.1")},
            SURFACES);
}

static void smoke_in_glass_in_fog(void **state)
{
    assert_true_objects(&(struct view){.lights = LAMP, .media = FOG, .objects = FLOOR("") ", " BALL(GLASS)}, MEDIA);
    assert_true_objects(&(struct view){.lights = LAMP,
                                       .media = FOG,
                                       .objects = FLOOR("") ", " BALL(GLASS SMOKE) ", " PAIR("\"kind\": \"mirror\""),
                                       .quality = MIDPOINT},
                        MEDIA);
}

// Renderer and reference have random numbers of their own. Their means must differ as means of so many samples do.
static void rough_surfaces_have_the_true_mean(void **state)
{
    enum { ACROSS_PX = 6, DOWN_PX = 4, SEEN = 256, TAKEN = 1024, COUNT = 3 * ACROSS_PX * DOWN_PX };
    static struct reference_sample samples[TAKEN];
    const struct view view = {.lights = LAMP,
                              .objects = FLOOR(", \"specular\": 0.6, \"roughness\": 0.3") ", " BALL(
                                  GLASS ", \"roughness\": 0.2") ", " PAIR("\"kind\": \"mirror\", \"roughness\": 0.5")};
    double square = 0.0, offset = 0.0, variance = 0.0;
    struct image image;
    struct job job;

    parse(&job, &view);
    job.width_px = ACROSS_PX;
    job.height_px = DOWN_PX;
    job.quality.samples = SEEN;
    render_frame_zero(&job, &image);
    for (int i = 0; i < TAKEN; ++i)
        samples[i] = (struct reference_sample){(i % 32 + 0.5) / 32.0, (i / 32 + 0.5) / 32.0, 0.0, (uint64_t)i};
    for (int i = 0; i < COUNT; ++i) {
        int x = i / 3 % ACROSS_PX, y = i / 3 / ACROSS_PX;
        struct reference_pixel pixel = reference_measure_samples(&job, NULL, x, y, samples, TAKEN, NULL);
        double error = pixel.radiance_error[i % 3] * sqrt(1.0 + (double)TAKEN / SEEN);
        double difference = image.rgba[4 * (i / 3) + i % 3] - pixel.radiance[i % 3];

        square += difference * difference / (error * error + 1e-12);
        offset += difference;
        variance += error * error;
    }
    print_message("%.3f of the expected square, offset by %.2f standard errors\n", square / COUNT,
                  offset / sqrt(variance));
    // Stratified samples lower the square. The three colours of a pixel are correlated, so the sum's standard error is
    // up to sqrt(3) times as large.
    assert_true(square / COUNT < 1.2);
    assert_near(offset, 0.0, 4.0 * sqrt(3.0 * variance));
    image_finish(&image);
    job_finish(&job);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_glass_ball_on_a_floor),
        cmocka_unit_test(mirrors_and_unions_of_mirrors),
        cmocka_unit_test(later_objects_in_earlier_ones),
        cmocka_unit_test(objects_that_touch),
        cmocka_unit_test(seen_from_within),
        cmocka_unit_test(smoke_in_glass_in_fog),
        cmocka_unit_test(rough_surfaces_have_the_true_mean),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
