// Tracking and its estimators: unbiased estimators have the right mean in all media, the others come closer to it.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/bias_check.h"
#include "tests/support/folders.h"
#include "tests/support/temp_folder.h"
#include "tests/support/volume_maker.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#define BALL "\"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 0.9"
#define COLOURED "\"sigma_s\": [2, 1, 3], \"sigma_a\": [0.2, 1, 0.5]"
#define EVEN "{ " COLOURED ", \"density\": { \"kind\": \"homogeneous\", " BALL " } } }"
#define SOFT "{ " COLOURED ", \"density\": { \"kind\": \"homogeneous\", " BALL ", \"falloff\": 0.8 } } }"
#define NOISE                                                                                                          \
    "{ " COLOURED ", \"emission\": [0.1, 0.2, 0.3], \"phase\": [ { \"g\": 0.4, \"weight\": 1 } ], \"density\": {"      \
    " \"kind\": \"noise\", \"frequency\": 2.5, \"octaves\": 2, \"H\": 0.6, \"lacunarity\": 2, \"bias\": 0.2,"          \
    " \"mode\": \"clip\", \"scale\": 4, " BALL ", \"falloff\": 0.3 } } }"
#define FRACTAL                                                                                                        \
    "{ \"density\": { \"kind\": \"fold_fractal\", \"iterations\": 3, \"offset\": 0.05, \"radius\": 0.4,"               \
    " \"rotate_x_rad\": 0.3, \"rotate_y_rad\": 0.7, \"exponent\": 1.3, \"scale\": 12 }, " COLOURED " }"
#define GLOW                                                                                                           \
    "{ \"sigma_s\": 0, \"sigma_a\": 0, \"emission\": [1, 0.4, 0.1], \"density\": { \"kind\": \"homogeneous\","         \
    " \"bounds\": { \"kind\": \"box\", \"center\": [0.4, 0.2, 0], \"size\": [0.7, 0.6, 0.5], \"falloff\": 0.2 } } }"
#define SUN "{ \"kind\": \"sun\", \"intensity\": [3, 2, 1], \"direction\": [-1, -2, 0.5] },"
#define LAMP "{ \"kind\": \"point\", \"intensity\": [1, 3, 2], \"position\": [1.2, 1, 0.9] },"

#define RATIO "\"method\": \"tracking\", \"estimator\": \"ratio\""
#define DELTA "\"method\": \"tracking\", \"estimator\": \"delta\""
#define MARCHED(NAME, STEP)                                                                                            \
    "\"method\": \"tracking\", \"estimator\": \"" NAME "\", \"step\": " STEP ", \"light_step\": " STEP

// Seeds of frames are fixed: a test that passes once passes always.
static void assert_unbiased(const struct bias_check_scene *scene, const double *truth)
{
    struct bias_check_errors errors = bias_check_measure(scene, truth, 1024);

    assert_true(fabs(errors.sigmas) < 3.5);
    // Few bright values hold most of the variance, and colours share collisions.
    assert_true(errors.chance > 0.4 && errors.chance < 1.9);
    assert_true(errors.spread > 1e-3);
}

static void assert_all_unbiased(const char *media, const char *lights)
{
    static const char *const qualities[] = {RATIO, DELTA, MARCHED("debiased", "0.3")};
    static double truth[BIAS_CHECK_VALUES];
    struct bias_check_scene scene = {.media = media, .lights = lights, .quality = RATIO};

    bias_check_find_truth(&scene, truth);
    for (size_t i = 0; i < sizeof qualities / sizeof *qualities; ++i) {
        scene.quality = qualities[i];
        assert_unbiased(&scene, truth);
    }
}

static void even_media_are_right_on_the_average(void **state)
{
    (void)state;
    assert_all_unbiased(EVEN, SUN);
}

static void soft_media_are_right_on_the_average(void **state)
{
    (void)state;
    assert_all_unbiased(SOFT, LAMP);
}

static void noise_is_right_on_the_average(void **state)
{
    (void)state;
    assert_all_unbiased(NOISE, SUN);
}

static void fractals_are_right_on_the_average(void **state)
{
    (void)state;
    assert_all_unbiased(FRACTAL, SUN);
}

static void several_media_are_right_on_the_average(void **state)
{
    (void)state;
    assert_all_unbiased(EVEN ", " FRACTAL ", " GLOW, SUN);
}

static void media_without_lights_are_right_on_the_average(void **state)
{
    (void)state;
    assert_all_unbiased(NOISE ", " GLOW, NULL);
}

// The voxels are a few lumps in an empty box, so that some bricks are empty and majorants of others differ.
static void write_lumps(const char *path)
{
    enum { X = 20, Y = 18, Z = 19 };
    unsigned char voxels[X * Y * Z];

    for (int n = 0; n < X * Y * Z; ++n) {
        double x = n % X, y = n / X % Y, z = n / X / Y;
        double near = hypot(hypot(x - 5, y - 6), z - 6), far = hypot(hypot(x - 14, y - 12), z - 13);

        voxels[n] = (unsigned char)fmax(60 - 12 * near, fmax(200 - 40 * far, 0));
    }
    volume_maker_write(path, voxels, sizeof voxels);
}

#define GRID                                                                                                           \
    "\"density\": { \"kind\": \"grid\", \"file\": \"%s\", \"spacing\": [0.09, 0.09, 0.09], \"center\": [0, 0, 0]"

static void grids_are_right_on_the_average(void **state)
{
    const char *path = temp_folder_path(state, "lumps_20x18x19xuint8.raw");
    char media[1024];

    write_lumps(path);
    snprintf(media, sizeof media, "{ " COLOURED ", " GRID ", \"scale\": 0.02 } }", path);
    assert_all_unbiased(media, SUN);
}

static void transfer_functions_are_right_on_the_average(void **state)
{
    const char *path = temp_folder_path(state, "lumps_20x18x19xuint8.raw");
    char media[1024];

    write_lumps(path);
    snprintf(media, sizeof media,
             "{ " GRID ", \"transfer_function\": [[5, 0, 0, 0, 0], [30, 1, 0.3, 0.1, 0.4], [60, 0.2, 0.5, 1, 0.1],"
             " [150, 1, 1, 1, 0.9]], \"unit_distance\": 0.3 } }",
             path);
    assert_all_unbiased(media, NULL);
}

static void sparse_grids_are_right_on_the_average(void **state)
{
    (void)state;
    assert_all_unbiased(
        "{ \"density\": { \"kind\": \"grid\", \"file\": \"" PROJECT_ROOT
        "/jobs/smoke/smoke.0010.nvdb\", \"grid\": \"density\", \"scale\": 1, \"center\": [0, -0.5, 0] },"
        " \"sigma_s\": [6, 6, 7], \"sigma_a\": [1, 2, 3], \"blackbody\": { \"grid\": \"temperature\","
        " \"kelvin\": 560, \"intensity\": 2 } }",
        SUN);
}

#define CODE(MAJORANT)                                                                                                 \
    "{ " COLOURED ", \"density\": { \"kind\": \"glsl\", \"source\": \"float density(vec3 p, float t) { return 1.0 -"   \
    " length(p); }\", \"majorant\": " MAJORANT ", \"scale\": 3, " BALL " } } }"
#define AS_CODE                                                                                                        \
    "{ " COLOURED ", \"density\": { \"kind\": \"fold_fractal\", \"iterations\": 1, \"offset\": 0, \"radius\": 1,"      \
    " \"exponent\": 1, \"scale\": 3, " BALL " } } }"

static void own_code_is_right_on_the_average(void **state)
{
    static double truth[BIAS_CHECK_VALUES];
    struct bias_check_scene scene = {.media = AS_CODE, .lights = SUN, .quality = RATIO};

    (void)state;
    bias_check_find_truth(&scene, truth);
    scene.media = CODE("1");
    assert_unbiased(&scene, truth);
    scene.media = CODE("2.5");
    assert_unbiased(&scene, truth);
    scene.quality = DELTA;
    assert_unbiased(&scene, truth);
}

// The grains are a third of the step long and act by absorption alone.
static void marches_are_debiased(void **state)
{
    static const char grains[] =
        "{ \"sigma_s\": 0, \"sigma_a\": 3, \"density\": { \"kind\": \"noise\", \"frequency\": 3,"
        " \"octaves\": 1, \"mode\": \"clip\", \"scale\": 4, " BALL " } } }";
    static double truth[BIAS_CHECK_VALUES];
    struct bias_check_scene scene = {.media = grains, .background = "1", .quality = MARCHED("jackknife", "0.5")};
    struct bias_check_errors jackknife, jittered, debiased;

    (void)state;
    bias_check_find_truth(&scene, truth);
    jackknife = bias_check_measure(&scene, truth, 192);
    scene.quality = "\"method\": \"jittered\", \"step\": 0.5, \"light_step\": 0.5";
    jittered = bias_check_measure(&scene, truth, 192);
    scene.quality = MARCHED("debiased", "0.5");
    debiased = bias_check_measure(&scene, truth, 1024);
    assert_true(jittered.sigmas > 10);
    assert_true(fabs(debiased.sigmas) < 3.5);
    assert_true(fabs(jackknife.bias) < 0.2 * jittered.bias);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(even_media_are_right_on_the_average),
        cmocka_unit_test(soft_media_are_right_on_the_average),
        cmocka_unit_test(noise_is_right_on_the_average),
        cmocka_unit_test(fractals_are_right_on_the_average),
        cmocka_unit_test(several_media_are_right_on_the_average),
        cmocka_unit_test(media_without_lights_are_right_on_the_average),
        cmocka_unit_test_setup_teardown(grids_are_right_on_the_average, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(transfer_functions_are_right_on_the_average, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test(sparse_grids_are_right_on_the_average),
        cmocka_unit_test(own_code_is_right_on_the_average),
        cmocka_unit_test(marches_are_debiased),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
