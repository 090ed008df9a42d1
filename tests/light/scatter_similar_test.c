// Walks that go on through similar media after some scatterings: against reference/, and a white furnace.
// SPDX-License-Identifier: Apache-2.0
#include "core/job/job.h"
#include "tests/support/bias_check.h"
#include "tests/support/render_frame.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#define BALL                                                                                                           \
    "\"density\": { \"kind\": \"homogeneous\","                                                                        \
    " \"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 0.9 } } }"
#define SHARP "{ \"sigma_s\": 12, \"sigma_a\": 0.05, \"phase\": [ { \"g\": 0.85 } ], " BALL
#define LOBES                                                                                                          \
    "{ \"sigma_s\": [6, 9, 12], \"sigma_a\": [0.4, 0.1, 0.1], \"phase\": [ { \"g\": 0.9, \"weight\": 0.6 },"           \
    " { \"kind\": \"rayleigh\", \"weight\": 0.2 }, { \"g\": -0.3, \"weight\": 0.2 } ], " BALL
#define SHARPER "{ \"sigma_s\": 8, \"sigma_a\": 0.05, \"phase\": [ { \"g\": 0.95 } ], " BALL
#define WHITE "{ \"sigma_s\": 12, \"sigma_a\": 0, \"phase\": [ { \"g\": 0.85 } ], " BALL
#define SUN "{ \"kind\": \"sun\", \"intensity\": [3, 2, 1], \"direction\": [-1, -2, -0.8] },"
#define LAMP "{ \"kind\": \"point\", \"intensity\": [4, 9, 6], \"position\": [1.5, 0.6, 1.2] },"
#define SKY "{ \"kind\": \"dome\", \"radiance\": 1 },"
#define GRID                                                                                                           \
    "\"method\": \"cached\", \"step\": 0.02, \"light_grid\": 48, \"scatter_grid\": 20, \"scatter_from\": \"nodes\","   \
    " \"paths\": 1024"
#define SIMILAR GRID ", \"similar_after\": 2"

static struct image render(const struct bias_check_scene *scene)
{
    struct image image;
    struct job job;

    bias_check_parse(&job, scene);
    render_frame_zero(&job, &image);
    job_finish(&job);
    return image;
}

// Returns by how much the mean light is off. The limit is of the whole error.
static double assert_true_to(const char *media, const char *lights, const char *quality, double limit)
{
    struct bias_check_scene scene = {
        .media = media, .lights = lights, .orders = "\"all\"", .background = "0", .quality = quality};
    double truth[BIAS_CHECK_VALUES], noise[BIAS_CHECK_VALUES], square = 0, power = 0, off = 0, all = 0, error;
    struct image image = render(&scene);

    scene.quality = "\"method\": \"paths\", \"paths\": 1";
    bias_check_find_paths(&scene, 1000, truth, noise);
    for (size_t i = 0; i < BIAS_CHECK_VALUES; i++) {
        double value = image.rgba[i / 3 * 4 + i % 3];

        square += pow(value - truth[i], 2) - pow(noise[i], 2);
        power += pow(truth[i], 2);
        off += value - truth[i];
        all += truth[i];
    }
    image_finish(&image);
    error = sqrt(fmax(square, 0) / power);
    print_message("error %.4f, mean off by %+.4f\n", error, off / all);
    if (!(error < limit)) fail_msg("%.4f, expected less than %.4f", error, limit);
    return off / all;
}

// The limits are twice what grid, walks and similar media err by here. With the extinction of the scene on the way to
// the lamp, most light is missing.
static void similar_media_bring_the_light_of_the_reference(void **state)
{
    (void)state;
    assert_true(fabs(assert_true_to(SHARP, SUN, SIMILAR, 0.09)) < 0.03);
    assert_true(fabs(assert_true_to(LOBES, SUN SKY, SIMILAR, 0.03)) < 0.015);
}

// In so sharp a lobe walks look for the lamp. The limits are twice what grid, walks and similar media err by here.
static void sharp_lobes_bring_the_light_of_the_reference(void **state)
{
    (void)state;
    assert_true(fabs(assert_true_to(SHARPER, SUN, GRID ", \"similar_after\": 8", 0.12)) < 0.03);
    assert_true(fabs(assert_true_to(SHARPER, SUN LAMP, GRID ", \"similar_after\": 8", 0.12)) < 0.03);
}

// All that is scattered comes from the sky, however often and by whatever media.
static void white_furnace_is_even(void **state)
{
    const struct bias_check_scene scene = {
        .media = WHITE, .lights = SKY, .orders = "\"all\"", .background = "0", .quality = SIMILAR};
    struct image image = render(&scene);

    (void)state;
    for (size_t i = 0; i < BIAS_CHECK_VALUES; i++)
        assert_float_equal(image.rgba[i / 3 * 4 + i % 3], 1 - image.transmittance[i / 3 * 4 + i % 3], 1e-3);
    image_finish(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(similar_media_bring_the_light_of_the_reference),
        cmocka_unit_test(sharp_lobes_bring_the_light_of_the_reference),
        cmocka_unit_test(white_furnace_is_even),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
