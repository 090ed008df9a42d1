// Media in regions of every kind, overlapping, around the camera and around lights, against the converged integral.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/assert_near.h"
#include "tests/support/render_frame.h"
#include "tests/support/true_light.h"
#include "worker/picture/image.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define CAMERA_OUTSIDE "\"position\": [0.9, 0.7, -2.1], \"target\": [0.05, 0, 0], \"clip\": [0, 4]"
#define CAMERA_INSIDE "\"position\": [0.2, 0.1, -0.3], \"target\": [0.1, 0.2, 1]"
#define MIDPOINT "\"method\": \"midpoint\", \"step\": 0.01, \"light_step\": 0.01"
#define EQUIANGULAR "\"method\": \"equiangular\", \"points\": 16"
#define EVEN(BOUNDS, MORE) "{ \"density\": { \"kind\": \"homogeneous\", \"scale\": 2" BOUNDS " }, " MORE " }"
#define BOX ", \"bounds\": { \"kind\": \"box\", \"center\": [0.1, -0.1, 0.2], \"size\": [1.1, 0.7, 0.9] }"
#define SPHERE ", \"bounds\": { \"kind\": \"sphere\", \"center\": [-0.2, 0.1, 0], \"radius\": 0.5 }"
#define SLAB                                                                                                           \
    ", \"bounds\": { \"kind\": \"slab\", \"center\": [0, 0.1, 0], \"normal\": [0.1, 2, -0.4], \"thickness\": 0.3 }"
#define FRACTAL                                                                                                        \
    "{ \"density\": { \"kind\": \"fold_fractal\", \"iterations\": 3, \"offset\": 0.05, \"radius\": 0.3,"               \
    " \"rotate_x_rad\": 0.3, \"rotate_y_rad\": 0.7, \"exponent\": 1.3, \"scale\": 10 }, \"sigma_s\": 6 }"
#define POINT_INSIDE "{ \"kind\": \"point\", \"intensity\": [3, 2, 1], \"position\": [0.15, -0.05, 0.3] }"
#define POINT_OUTSIDE "{ \"kind\": \"point\", \"intensity\": [1, 3, 2], \"position\": [0.9, 0.8, 0.2] }"
#define EVEN_POINT "{ \"kind\": \"point\", \"falloff\": \"none\", \"intensity\": 2, \"position\": [-0.9, 0.8, -0.7] }"
#define SUN "{ \"kind\": \"sun\", \"intensity\": [0.5, 1, 2], \"direction\": [1, -2, 0.5] }"
#define COLORS                                                                                                         \
    "\"sigma_s\": [0.4, 0.8, 1.6], \"sigma_a\": [0.5, 0.2, 0],"                                                        \
    " \"phase\": [ { \"g\": 0.6, \"weight\": 0.4 }, { \"kind\": \"rayleigh\", \"weight\": 0.6 } ]"

static void parse(struct job *job, const char *camera, const char *lights, const char *media, const char *quality)
{
    struct error error = {{0}};
    char text[4096];

    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"media\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [24, 16],"
             " \"camera\": { %s, \"up\": [0.1, 1, 0], \"fov\": 40 }, \"lights\": [ %s ],"
             " \"scene\": { \"media\": [ %s ] }, \"quality\": { %s },"
             " \"output\": { \"path\": \"media.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] } }",
             camera, lights, media, quality);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

static void assert_true_light(const char *camera, const char *lights, const char *media, const char *quality,
                              double tolerance)
{
    struct true_light light;
    struct job job;

    parse(&job, camera, lights, media, quality);
    light = true_light_compare(&job, GL_BACKEND_SOFTWARE);
    assert_true(true_light_is_within(&light, tolerance));
    job_finish(&job);
}

// Steps of a fiftieth of the media are of second order. A wrong position or direction at a face costs whole per cents.
static const double march_tolerance = 3e-4;
// The error of 16 points is a tenth of that of 8. It is largest at faces, where the optical depth to a light has a
// kink, and with a light in front of the camera.
static const double placed_tolerance = 2e-4;
// Closed forms have a few roundings.
static const double exact_tolerance = 3e-6;

static void homogeneous_media_are_marched_with_shadows_in_closed_form(void **state)
{
    assert_true_light(CAMERA_OUTSIDE, POINT_OUTSIDE ", " SUN, EVEN(BOX, COLORS), MIDPOINT, march_tolerance);
    assert_true_light(CAMERA_OUTSIDE, EVEN_POINT, EVEN(SLAB, COLORS), MIDPOINT, march_tolerance);
}

static void media_of_every_region_overlap(void **state)
{
    assert_true_light(CAMERA_OUTSIDE, POINT_OUTSIDE ", " EVEN_POINT,
                      EVEN(BOX, COLORS) ", " EVEN(SPHERE, "\"sigma_s\": 1, \"emission\": [0.1, 0, 0.3]") ", " EVEN(
                          SLAB, "\"sigma_a\": [1, 2, 3]"),
                      MIDPOINT, march_tolerance);
}

#define SMOKE(X)                                                                                                       \
    "{ \"density\": { \"kind\": \"noise\", \"frequency\": 2, \"scale\": 4, \"bounds\": { \"kind\": \"sphere\", "       \
    "\"center\": [" X ", 0, 0], \"radius\": 0.2, \"falloff\": 0.1 } }, " COLORS " }"

// Shadow rays lead from one ball through empty space into the other, which must not be stepped over.
static void a_ball_in_another_ones_shadow(void **state)
{
    assert_true_light(CAMERA_OUTSIDE, "{ \"kind\": \"sun\", \"intensity\": 1, \"direction\": [1, 0, 0] }",
                      SMOKE("-0.5") ", " SMOKE("0.5"), MIDPOINT, 1e-3);
}

static void a_homogeneous_medium_around_a_fractal(void **state)
{
    // The homogeneous medium leaves no empty space to step over up to the fractal's faces, where density has a kink.
    assert_true_light(CAMERA_OUTSIDE, SUN, FRACTAL ", " EVEN(SPHERE, COLORS), MIDPOINT, 1.5e-3);
}

// Riemann sums along the ray and to the light are of first order: an error of 5e-2. The medium behind the light is no
// part of the sum.
static void sums_of_homogeneous_media_end_at_the_light(void **state)
{
    assert_true_light(
        CAMERA_OUTSIDE,
        "{ \"kind\": \"point\", \"falloff\": \"none\", \"intensity\": 2, \"position\": [-0.2, 0.1, 0.05] }",
        FRACTAL ", " EVEN(SPHERE, COLORS), "\"method\": \"riemann\", \"step\": 0.01, \"light_steps\": 32", 7e-2);
}

// Samples of Riemann sums are at fixed points, in front of a region and behind it, too. First order: an error of 1 %.
static void sums_of_one_medium_end_with_its_region(void **state)
{
    static const char *const quality = "\"method\": \"riemann\", \"step\": 0.005, \"light_steps\": 64";

    assert_true_light(CAMERA_OUTSIDE, POINT_OUTSIDE, EVEN(BOX, COLORS), quality, 3e-2);
    assert_true_light(CAMERA_OUTSIDE, POINT_OUTSIDE,
                      "{ \"density\": { \"kind\": \"noise\", \"frequency\": 2, \"scale\": 3" SPHERE " }, " COLORS " }",
                      quality, 3e-2);
}

static void homogeneous_media_without_light_are_exact(void **state)
{
    static const char *const qualities[] = {MIDPOINT, EQUIANGULAR};

    for (int i = 0; i < 2; ++i) {
        assert_true_light(CAMERA_OUTSIDE, "",
                          EVEN(BOX, "\"sigma_a\": [3, 2, 1]") ", " EVEN(
                              SPHERE, "\"sigma_a\": 1, \"emission\": [0.1, 0, 0.3]") ", " EVEN(SLAB,
                                                                                               "\"sigma_a\": [1, 2, "
                                                                                               "3]"),
                          qualities[i], exact_tolerance);
        assert_true_light(CAMERA_INSIDE, "",
                          EVEN("", "\"sigma_a\": [3, 2, 1], \"emission\": 1") ", " EVEN(SPHERE, "\"sigma_a\": 1"),
                          qualities[i], exact_tolerance);
    }
}

static void assert_true_depth(const char *lights, const char *media, const char *quality)
{
    struct still still;
    struct image image;
    struct job job;
    int seen = 0;

    parse(&job, CAMERA_OUTSIDE, lights, media, quality);
    render_frame_zero(&job, &image);
    still_init(&still, &job, job_frame_time(&job, 0));
    for (int i = 0; i < job.width_px * job.height_px; ++i) {
        double wanted = reference_measure_depth(&still, i % job.width_px, i / job.width_px);

        // The tolerance is rounding: a depth of some 2 m is the sum of up to 100 steps.
        assert_near(image.depth[i], wanted, 2e-5);
        seen += wanted > 0;
    }
    assert_true(seen > 20);
    image_finish(&image);
    job_finish(&job);
}

// Colours fade over different lengths. The point where the mean of their exponentials is a half has no closed form.
static void depth_is_where_the_mean_of_colours_is_half(void **state)
{
    assert_true_depth("", EVEN(SPHERE, "\"sigma_a\": [0.3, 1, 6]") ", " EVEN(BOX, "\"sigma_a\": [2, 0.5, 0]"),
                      MIDPOINT);
}

// The transmittance of a ray that survives roulette is weighted up to over a half, and falls below it a second time.
static void depth_is_where_half_is_lost_first(void **state)
{
    assert_true_depth(POINT_OUTSIDE, EVEN(SPHERE, "\"sigma_s\": 2, \"sigma_a\": 4"),
                      MIDPOINT ", \"roulette\": { \"below\": 0.45, \"survive\": 0.5 }");
}

static void a_falloff_softens_a_region(void **state)
{
    assert_true_light(CAMERA_OUTSIDE, POINT_OUTSIDE,
                      EVEN(", \"bounds\": { \"kind\": \"sphere\", \"center\": [-0.1, 0, 0.1], \"radius\": 0.6,"
                           " \"falloff\": 0.4 }",
                           COLORS) ", " EVEN(BOX, "\"sigma_a\": [1, 2, 3]"),
                      MIDPOINT, march_tolerance);
}

static void points_placed_for_each_light(void **state)
{
    assert_true_light(CAMERA_OUTSIDE, POINT_OUTSIDE, EVEN(SPHERE, COLORS), EQUIANGULAR, placed_tolerance);
    assert_true_light(CAMERA_OUTSIDE, SUN, EVEN(SLAB, COLORS), EQUIANGULAR, placed_tolerance);
    assert_true_light(CAMERA_OUTSIDE, EVEN_POINT, EVEN(SPHERE, COLORS), EQUIANGULAR, placed_tolerance);
    assert_true_light(CAMERA_OUTSIDE, POINT_INSIDE, EVEN(SLAB, COLORS), EQUIANGULAR, placed_tolerance);
    assert_true_light(CAMERA_INSIDE, POINT_INSIDE, EVEN("", COLORS), EQUIANGULAR, placed_tolerance);
    assert_true_light(CAMERA_OUTSIDE, POINT_INSIDE ", " SUN,
                      EVEN(BOX, COLORS) ", " EVEN(SPHERE, "\"sigma_s\": 1, \"emission\": [0.1, 0, 0.3]"), EQUIANGULAR,
                      placed_tolerance);
}

static double radiance_error(const char *lights, const char *media, const char *quality)
{
    struct true_light light;
    struct job job;

    parse(&job, CAMERA_OUTSIDE, lights, media, quality);
    light = true_light_compare(&job, GL_BACKEND_SOFTWARE);
    job_finish(&job);
    return light.radiance.relative_rmse;
}

static void thin_and_thick_media_under_every_light(void **state)
{
    // Extinction 10,000 times as large makes a position's rounding an error of optical depth 10,000 times as large.
    static const struct {
        const char *scale, *power;
        double tolerance;
    } cases[] = {{"1e-6", "1e6", 1e-5}, {"1e-2", "100", 1e-5}, {"1", "1", 3e-5},  {"10", "1", 4e-4},
                 {"100", "1", 2e-4},    {"1e3", "1", 1e-3},    {"1e4", "1", 1e-2}};

    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        static const char *const lights[] = {
            "{ \"kind\": \"point\", \"position\": [0.9, 0.8, 0.2], \"intensity\": ",
            "{ \"kind\": \"point\", \"falloff\": \"none\", \"position\": [-0.9, 0.8, -0.7], \"intensity\": ",
            "{ \"kind\": \"sun\", \"direction\": [1, -2, 0.5], \"intensity\": "};

        for (int k = 0; k < 3; ++k) {
            char medium[512], light[128];

            snprintf(medium, sizeof medium,
                     "{ \"density\": { \"kind\": \"homogeneous\", \"scale\": %s" SPHERE " }, " COLORS " }",
                     cases[i].scale);
            snprintf(light, sizeof light, "%s%s }", lights[k], cases[i].power);
            assert_true(radiance_error(light, medium, EQUIANGULAR) <= cases[i].tolerance);
        }
    }
}

// One colour's mean free path is a thousandth of another's. Without points of its own it is half as bright as it should
// be. The remaining error comes from steep shadows at the ball's rim, where the densest colour is lit.
static void colours_of_very_different_extinction(void **state)
{
    static const char *const media[] = {EVEN(SPHERE, "\"sigma_s\": [100, 10, 1]"),
                                        EVEN(SPHERE, "\"sigma_s\": [1, 1000, 30]"),
                                        EVEN(SPHERE, "\"sigma_s\": [0, 0, 400], \"sigma_a\": [0, 0.1, 0]")};

    for (size_t i = 0; i < sizeof media / sizeof *media; ++i) {
        assert_true(radiance_error(POINT_OUTSIDE, media[i], EQUIANGULAR) <= 5e-3);
        assert_true(radiance_error(SUN, media[i], EQUIANGULAR) <= 5e-3);
    }
}

static void twice_the_points_are_ten_times_closer(void **state)
{
    static const char *const counts[] = {"4", "8", "16"}; // 32 points have less error than reference/
    double before = 1;

    for (int i = 0; i < 3; ++i) {
        char quality[128];
        double error;

        snprintf(quality, sizeof quality, "\"method\": \"equiangular\", \"points\": %s", counts[i]);
        error = radiance_error(POINT_OUTSIDE, EVEN(SPHERE, COLORS), quality);
        assert_true(error < before / 5);
        before = error;
    }
}

// More than 64 points are divided among several Gauss rules, one behind the other along the ray.
static void many_points_cover_the_whole_ray(void **state)
{
    assert_true(radiance_error(POINT_OUTSIDE, EVEN(SPHERE, COLORS), "\"method\": \"equiangular\", \"points\": 150") <
                1e-4);
}

static void sharp_phases_need_more_points(void **state)
{
    static const struct {
        const char *g;
        double tolerance;
    } cases[] = {{"-0.9", 1e-4}, {"0.9", 1e-4}, {"0.99", 1e-4}};

    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char medium[512];

        snprintf(medium, sizeof medium, EVEN(SPHERE, "\"sigma_s\": 1, \"phase\": [ { \"g\": %s } ]"), cases[i].g);
        assert_true(radiance_error(POINT_OUTSIDE ", " SUN ", " EVEN_POINT, medium,
                                   "\"method\": \"equiangular\", \"points\": 64") <= cases[i].tolerance);
    }
}

// One argument: the tests to run, by a pattern.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(homogeneous_media_are_marched_with_shadows_in_closed_form),
        cmocka_unit_test(media_of_every_region_overlap),
        cmocka_unit_test(a_ball_in_another_ones_shadow),
        cmocka_unit_test(a_homogeneous_medium_around_a_fractal),
        cmocka_unit_test(sums_of_homogeneous_media_end_at_the_light),
        cmocka_unit_test(sums_of_one_medium_end_with_its_region),
        cmocka_unit_test(homogeneous_media_without_light_are_exact),
        cmocka_unit_test(depth_is_where_the_mean_of_colours_is_half),
        cmocka_unit_test(depth_is_where_half_is_lost_first),
        cmocka_unit_test(a_falloff_softens_a_region),
        cmocka_unit_test(points_placed_for_each_light),
        cmocka_unit_test(thin_and_thick_media_under_every_light),
        cmocka_unit_test(colours_of_very_different_extinction),
        cmocka_unit_test(twice_the_points_are_ten_times_closer),
        cmocka_unit_test(many_points_cover_the_whole_ray),
        cmocka_unit_test(sharp_phases_need_more_points),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
