// The cached method against the converged integral: lights inside and outside, all kinds of media, finer grids.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/example_job.h"
#include "tests/support/true_light.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define FRACTAL                                                                                                        \
    "{ \"density\": { \"kind\": \"fold_fractal\", \"iterations\": 3, \"offset\": 0.05, \"radius\": 0.3,"               \
    " \"rotate_x_rad\": 0.3, \"rotate_y_rad\": 0.7, \"exponent\": 1.3, \"scale\": 10 }, \"sigma_s\": 6 }"
#define HAZE                                                                                                           \
    "{ \"density\": { \"kind\": \"homogeneous\", \"scale\": 2,"                                                        \
    " \"bounds\": { \"kind\": \"sphere\", \"center\": [-0.2, 0.1, 0], \"radius\": 0.5 } },"                            \
    " \"sigma_s\": [0.4, 0.8, 1.6], \"sigma_a\": [0.5, 0.2, 0] }"
#define SOFT_BOX                                                                                                       \
    "{ \"density\": { \"kind\": \"homogeneous\", \"scale\": 2, \"bounds\": { \"kind\": \"box\","                       \
    " \"center\": [0.1, -0.1, 0.2], \"size\": [1.1, 0.7, 0.9], \"falloff\": 0.3 } }, \"sigma_s\": [0.4, 0.8, 1.6],"    \
    " \"phase\": [ { \"g\": 0.6, \"weight\": 0.4 }, { \"kind\": \"rayleigh\", \"weight\": 0.6 } ] }"
#define POINT_INSIDE "{ \"kind\": \"point\", \"intensity\": [3, 2, 1], \"position\": [0.15, -0.05, 0.3] }"
#define EVEN_INSIDE                                                                                                    \
    "{ \"kind\": \"point\", \"falloff\": \"none\", \"intensity\": [3, 2, 1], \"position\": [0.15, -0.05, 0.3] }"
#define POINT_OUTSIDE "{ \"kind\": \"point\", \"intensity\": [1, 3, 2], \"position\": [1.2, 1, -0.9] }"
#define EVEN_POINT "{ \"kind\": \"point\", \"falloff\": \"none\", \"intensity\": 2, \"position\": [-0.9, 0.8, -0.7] }"
#define SUN "{ \"kind\": \"sun\", \"intensity\": [0.5, 1, 2], \"direction\": [1, -2, 0.5] }"
#define CAMERA_OUTSIDE "[0.9, 0.7, -2.1]"
#define CAMERA_AT_LIGHT "[0.15, -0.05, 0.3]"

static void parse(struct job *job, const char *camera, const char *lights, const char *media, int cells)
{
    struct error error = {{0}};
    char text[4096];

    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"media\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [20, 14],"
             " \"camera\": { \"position\": %s, \"target\": [0.05, 0, 0.1], \"fov\": 40, \"clip\": [0, 4] },"
             " \"lights\": [ %s ], \"scene\": { \"media\": [ %s ] },"
             " \"quality\": { \"method\": \"cached\", \"step\": 0.01, \"light_grid\": %d },"
             " \"output\": { \"path\": \"media.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] } }",
             camera, lights, media, cells);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

// The error is at most `tolerance` with a light grid of 32 cells. It falls with the square of the number of cells, down
// to `floor`, the error of the camera's steps.
static void assert_shrinks(const char *camera, const char *lights, const char *media, double tolerance, double floor)
{
    struct true_light_truth truth = {.planes = NULL};

    for (int cells = 32; cells <= 128; cells *= 2) {
        double finer = cells / 32.0;
        struct true_light light;
        struct job job;

        parse(&job, camera, lights, media, cells);
        light = true_light_compare_with(&job, GL_BACKEND_SOFTWARE, &truth);
        assert_true(true_light_is_within(&light, tolerance / (finer * finer) + floor));
        job_finish(&job);
    }
    true_light_truth_finish(&truth);
}

static void a_lamp_inside_lights_media_all_round(void **state)
{
    (void)state;
    assert_shrinks(CAMERA_OUTSIDE, POINT_INSIDE, SOFT_BOX, 2.5e-4, 5e-5);
}

static void a_lamp_at_the_camera_is_met_by_every_ray(void **state)
{
    (void)state;
    assert_shrinks(CAMERA_AT_LIGHT, EVEN_INSIDE, SOFT_BOX, 5e-4, 6e-5);
}

static void several_lights_have_a_grid_each(void **state)
{
    (void)state;
    assert_shrinks(CAMERA_OUTSIDE, POINT_OUTSIDE ", " SUN ", " EVEN_POINT, FRACTAL ", " SOFT_BOX, 2e-3, 5e-5);
}

static void homogeneous_media_stay_in_closed_form(void **state)
{
    (void)state;
    assert_shrinks(CAMERA_OUTSIDE, POINT_INSIDE ", " SUN, HAZE ", " SOFT_BOX, 2.5e-4, 5e-5);
}

static void homogeneous_media_need_no_grid(void **state)
{
    struct true_light light;
    struct job job;

    (void)state;
    parse(&job, CAMERA_OUTSIDE, POINT_OUTSIDE, HAZE, 4);
    light = true_light_compare(&job, GL_BACKEND_SOFTWARE);
    assert_true(true_light_is_within(&light, 3e-4));
    job_finish(&job);
}

static void assert_example(const char *name, double time, enum gl_backend backend, const struct job_quality *quality,
                           double tolerance, struct true_light_truth *truth)
{
    struct true_light light;
    struct job job;

    example_job_load(&job, name);
    // The reference is slow on noise.
    if (strcmp(name, "noise") == 0)
        example_job_shrink(&job, 12, 7, time);
    else
        example_job_shrink(&job, 32, 18, time);
    job.quality = *quality;
    job.output.has_depth = job.output.has_transmittance = true;
    light = true_light_compare_with(&job, backend, truth);
    assert_true(true_light_is_within(&light, tolerance));
    job_finish(&job);
}

static struct job_quality quality_of(double step, int cells)
{
    return (struct job_quality){
        .method = JOB_METHOD_CACHED, .step = step, .light_grid = cells, .samples = 1, .max_depth = JOB_DEPTH_DEFAULT};
}

// Folds are finer than the cells of any grid: errors fall a little slower than with the square of the number of cells.
static void the_cloud_is_within_a_percent_at_80_cells(void **state)
{
    const struct job_quality coarse = quality_of(0.01, 40), fine = quality_of(0.01, 80), finer = quality_of(0.01, 256);

    struct true_light_truth truth = {.planes = NULL};

    (void)state;
    assert_example("cloud", 2, GL_BACKEND_SOFTWARE, &coarse, 3e-2, &truth);
    assert_example("cloud", 2, GL_BACKEND_SOFTWARE, &fine, 1e-2, &truth);
    assert_example("cloud", 2, GL_BACKEND_EGL, &finer, 2e-3, &truth);
    true_light_truth_finish(&truth);
}

static void segments_may_follow_optical_depth(void **state)
{
    struct job_quality quality = quality_of(0.02, 192);

    (void)state;
    quality.depth_step = 0.2;
    assert_example("cloud", 2, GL_BACKEND_SOFTWARE, &quality, 1e-2, NULL);
}

static void noise_is_the_converged_light(void **state)
{
    const struct job_quality quality = quality_of(0.02, 96);

    (void)state;
    assert_example("noise", 1, GL_BACKEND_SOFTWARE, &quality, 1e-2, NULL);
}

// One argument: the tests to run, by a pattern.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lamp_inside_lights_media_all_round),
        cmocka_unit_test(a_lamp_at_the_camera_is_met_by_every_ray),
        cmocka_unit_test(several_lights_have_a_grid_each),
        cmocka_unit_test(homogeneous_media_stay_in_closed_form),
        cmocka_unit_test(homogeneous_media_need_no_grid),
        cmocka_unit_test(the_cloud_is_within_a_percent_at_80_cells),
        cmocka_unit_test(segments_may_follow_optical_depth),
        cmocka_unit_test(noise_is_the_converged_light),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
