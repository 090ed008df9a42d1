// Marches by optical depth and by the rule of Gauss and Legendre: the light, and the order of convergence of each.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "reference/reference.h"
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

enum { WIDTH_PX = 16, HEIGHT_PX = 12, PIXELS = WIDTH_PX * HEIGHT_PX };

// Density falls from the middle to 0 on the face: a polynomial of the distance, smooth except in the middle itself.
#define SMOOTH_BALL                                                                                                    \
    "\"density\": { \"kind\": \"homogeneous\", \"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0],"             \
    " \"radius\": 1, \"falloff\": 1 } }"
#define GRAINS                                                                                                         \
    "\"density\": { \"kind\": \"noise\", \"frequency\": 3, \"octaves\": 2, \"mode\": \"clip\", \"scale\": 20,"         \
    " \"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 1 } }"
#define GLOWING "{ \"emission\": [2, 1, 1], \"sigma_a\": [2, 1, 0.5], " SMOOTH_BALL " }"
#define LIT "{ \"sigma_s\": [2, 1, 0.5], \"sigma_a\": 0.5, " SMOOTH_BALL " }"
#define THICK "{ \"sigma_s\": [300, 200, 100], \"sigma_a\": 50, " SMOOTH_BALL " }"
#define EVEN                                                                                                           \
    "{ \"sigma_s\": [300, 200, 100], \"sigma_a\": 50, \"density\": { \"kind\": \"homogeneous\","                       \
    " \"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 1 } } }"
#define UNIT_BOX "\"bounds\": { \"kind\": \"box\", \"center\": [0, 0, 0], \"size\": [2, 2, 2] }"
#define SUN "{ \"kind\": \"sun\", \"intensity\": 4, \"direction\": [-0.3, -0.4, -1] }"
#define FURNACE "{ \"sigma_a\": 4, \"emission\": 4, " GRAINS " }"
#define LAMP "{ \"kind\": \"point\", \"intensity\": 4, \"position\": [1.5, 1, 1] }"

struct scene_text {
    const char *media, *lights, *rest; // `rest` is members of the job that follow, each with a comma
};

static void parse(struct job *job, const struct scene_text *scene, const char *quality)
{
    struct error error = {{0}};
    char text[4096];

    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"steps\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [%d, %d],"
             " \"camera\": { \"position\": [0.1, 0.2, 4], \"target\": [0, 0, 0], \"up\": [0, 1, 0], \"fov\": 32 },"
             " \"lights\": [ %s ], %s \"scene\": { \"media\": [ %s ] }, \"quality\": { %s },"
             " \"output\": { \"path\": \"steps.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] } }",
             WIDTH_PX, HEIGHT_PX, scene->lights, scene->rest ? scene->rest : "", scene->media, quality);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

struct truth {
    double radiance[3 * PIXELS];
};

static struct truth measure(const struct scene_text *scene)
{
    struct truth truth;
    struct still still;
    struct job job;

    parse(&job, scene, "\"method\": \"midpoint\", \"step\": 1, \"light_step\": 1");
    still_init(&still, &job, 0);
    for (int i = 0; i < PIXELS; ++i) {
        struct reference_pixel pixel =
            reference_measure_pixel(&still, i % WIDTH_PX, i / WIDTH_PX, &(struct integrate_accuracy){.relative = 1e-6});

        assert_true(pixel.is_converged);
        memcpy(truth.radiance + 3 * i, pixel.radiance, sizeof pixel.radiance);
    }
    job_finish(&job);
    return truth;
}

static double find_error(const struct scene_text *scene, const char *quality, const struct truth *truth)
{
    float seen[3 * PIXELS];
    struct reference_error error;
    struct image image;
    struct job job;

    parse(&job, scene, quality);
    render_frame_zero(&job, &image);
    job_finish(&job);
    for (int i = 0; i < PIXELS; ++i)
        memcpy(seen + 3 * i, image.rgba + 4 * i, 3 * sizeof *seen);
    image_finish(&image);
    error = reference_image_error(seen, truth->radiance, 3 * PIXELS);
    print_message("%.2e of the light: %s\n", error.relative_rmse, quality);
    return error.relative_rmse;
}

#define GAUSS(ORDER, STEP) "\"method\": \"gauss\", \"order\": " ORDER ", \"step\": " STEP ", \"light_step\": " STEP
#define ADAPTIVE(DEPTH_STEP) "\"method\": \"adaptive\", \"step\": 0.1, \"light_step\": 0.1, \"depth_step\": " DEPTH_STEP
#define MIDPOINT(STEP) "\"method\": \"midpoint\", \"step\": " STEP ", \"light_step\": " STEP

// An error of order p is divided by 2^p where steps are half as long: 16 and 64 here.
static void assert_orders(const struct scene_text *scene)
{
    struct truth truth = measure(scene);
    double coarse = find_error(scene, GAUSS("2", "0.25"), &truth),
           fine = find_error(scene, GAUSS("2", "0.125"), &truth);
    double third = find_error(scene, GAUSS("3", "0.25"), &truth), third_fine;

    assert_true(fine < coarse / 11);
    assert_true(third < coarse / 4);
    third_fine = find_error(scene, GAUSS("3", "0.125"), &truth);
    assert_true(third_fine < third / 20 || third_fine < 3e-6);
    assert_true(find_error(scene, GAUSS("4", "0.25"), &truth) < third);
    // The midpoint rule is of second order with as many evaluations.
    assert_true(find_error(scene, MIDPOINT("0.0625"), &truth) > 5 * fine);
}

static void glowing_media_converge_at_the_rules_order(void **state)
{
    assert_orders(&(struct scene_text){.media = GLOWING, .lights = ""});
}

static void lit_media_converge_at_the_rules_order(void **state)
{
    assert_orders(&(struct scene_text){.media = LIT, .lights = LAMP});
}

// One ray goes straight through a box: two metres of absorption in one segment, in which the emission falls or rises
// linearly. Each node's transmittance has to count what is in front of it and not what is behind it. The integral of
// exp(-s) (1 - s / 2) over 0 to 2 is (1 + exp(-2)) / 2, that of exp(-s) s / 2 is (1 - 3 exp(-2)) / 2.
static void a_node_is_attenuated_by_what_is_in_front(void **state)
{
    static const struct {
        const char *quality;
        double allowed; // by rules of order 4, 6 and 8
    } rules[] = {{GAUSS("2", "2"), 3e-2}, {GAUSS("3", "2"), 4e-4}, {GAUSS("4", "2"), 5e-6}};
    static const char *const densities[] = {"0.5 + 0.5 * p.z", "0.5 - 0.5 * p.z"};
    const double lights[] = {0.5 * (1.0 + exp(-2.0)), 0.5 * (1.0 - 3.0 * exp(-2.0))};

    for (size_t i = 0; i < 6; ++i) {
        double light = lights[i % 2], apart;
        struct error error = {{0}};
        struct image image;
        struct job job;
        char text[2048];

        snprintf(text, sizeof text,
                 "{ \"version\": 1, \"name\": \"ray\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [1, 1],"
                 " \"camera\": { \"position\": [0, 0, 4], \"target\": [0, 0, 0], \"fov\": 20 },"
                 " \"scene\": { \"media\": [ { \"sigma_a\": 1, \"density\": { \"kind\": \"homogeneous\", " UNIT_BOX
                 " } },"
                 " { \"emission\": 1, \"sigma_a\": 0, \"density\": { \"kind\": \"glsl\","
                 " \"source\": \"float density(vec3 p, float t) { return %s; }\", " UNIT_BOX " } } ] },"
                 " \"quality\": { %s }, \"output\": { \"path\": \"ray.####.exr\", \"pixel\": \"float\" } }",
                 densities[i % 2], rules[i / 2].quality);
        if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
        render_frame_zero(&job, &image);
        apart = fabs((double)image.rgba[0] / light - 1.0);
        print_message("%.2e of the light: %s\n", apart, rules[i / 2].quality);
        assert_true(apart <= rules[i / 2].allowed);
        image_finish(&image);
        job_finish(&job);
    }
}

// Emission in balance with absorption before a background of 1 is 1, however rough the density and however long the
// steps.
static void nothing_is_gained_or_lost(void **state)
{
    static const char *const qualities[] = {GAUSS("2", "3"), GAUSS("3", "0.3"), GAUSS("4", "0.1"), ADAPTIVE("0.5"),
                                            ADAPTIVE("5")};
    const struct scene_text scene = {.media = FURNACE, .lights = "", .rest = "\"background\": 1,"};

    for (size_t i = 0; i < sizeof qualities / sizeof *qualities; ++i) {
        struct image image;
        struct job job;

        parse(&job, &scene, qualities[i]);
        render_frame_zero(&job, &image);
        job_finish(&job);
        for (int k = 0; k < PIXELS; ++k)
            for (int c = 0; c < 3; ++c)
                if (fabsf(image.rgba[4 * k + c] - 1.0f) > 2e-5f)
                    fail_msg("%s: pixel %d is %.8f", qualities[i], k, (double)image.rgba[4 * k + c]);
        image_finish(&image);
    }
}

// The optical depth of segments alone matters between the faces of a homogeneous ball.
static void errors_fall_with_the_square_of_the_depth(void **state)
{
    const struct scene_text scene = {.media = EVEN, .lights = SUN};
    struct truth truth = measure(&scene);
    double coarse = find_error(&scene, ADAPTIVE("0.4"), &truth), fine = find_error(&scene, ADAPTIVE("0.1"), &truth);

    assert_true(coarse < 2e-2);
    assert_true(fine < coarse / 10);
    assert_true(find_error(&scene, MIDPOINT("0.1"), &truth) > 5 * coarse);
}

// The density rises within each segment as well, so that short segments gain less than in a homogeneous medium.
static void segments_are_short_where_it_is_thick(void **state)
{
    const struct scene_text scene = {.media = THICK, .lights = LAMP};
    struct truth truth = measure(&scene);
    double coarse = find_error(&scene, ADAPTIVE("0.4"), &truth), fine = find_error(&scene, ADAPTIVE("0.1"), &truth);

    assert_true(find_error(&scene, MIDPOINT("0.1"), &truth) > 2.5 * fine);
    assert_true(fine < coarse / 2);
}

// A glass ball stands over a floor, with a shadow: regions divide the ray, and each has segments of its own.
static void marches_converge_with_objects(void **state)
{
    static const char *const qualities[] = {GAUSS("2", "0.1"), ADAPTIVE("0.1")};

    for (size_t i = 0; i < sizeof qualities / sizeof *qualities; ++i) {
        struct error error = {{0}};
        struct true_light light;
        struct job job;
        char text[4096];

        snprintf(text, sizeof text,
                 "{ \"version\": 1, \"name\": \"glass\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [16, 9],"
                 " \"camera\": { \"position\": [0, 1, 4], \"target\": [0, 0, 0], \"up\": [0, 1, 0], \"fov\": 36 },"
                 " \"lights\": [ { \"kind\": \"point\", \"intensity\": 20, \"position\": [1.5, 2.5, 1] } ],"
                 " \"background\": 0.2, \"scene\": { \"objects\": ["
                 " { \"kind\": \"plane\", \"point\": [0, -1.1, 0],"
                 "   \"material\": { \"kind\": \"diffuse\", \"albedo\": 0.5 } },"
                 " { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 1,"
                 "   \"material\": { \"kind\": \"dielectric\", \"ior\": 1.3,"
                 "   \"interior\": { \"sigma_s\": 2, \"sigma_a\": 1, " SMOOTH_BALL " } } } ] },"
                 " \"quality\": { %s, \"max_depth\": 4 },"
                 " \"output\": { \"path\": \"steps.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] } }",
                 qualities[i]);
        if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
        light = true_light_compare(&job, GL_BACKEND_SOFTWARE);
        assert_true(true_light_is_within(&light, 3e-3));
        job_finish(&job);
    }
}

// An argument is a pattern of the tests to run.
int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(glowing_media_converge_at_the_rules_order),
        cmocka_unit_test(lit_media_converge_at_the_rules_order),
        cmocka_unit_test(a_node_is_attenuated_by_what_is_in_front),
        cmocka_unit_test(nothing_is_gained_or_lost),
        cmocka_unit_test(errors_fall_with_the_square_of_the_depth),
        cmocka_unit_test(segments_are_short_where_it_is_thick),
        cmocka_unit_test(marches_converge_with_objects),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
