// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "reference/reference.h"
#include "tests/support/render_frame.h"
#include "worker/picture/image.h"
#include "worker/shader/scene_program.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 12, HEIGHT_PX = 8, PIXELS = WIDTH_PX * HEIGHT_PX };

#define BALL "\"bounds\": { \"kind\": \"sphere\", \"center\": [0.1, 0, -0.2], \"radius\": 0.5, \"falloff\": 0.1 }"
#define SUN "{ \"kind\": \"sun\", \"intensity\": [0.5, 1, 2], \"direction\": [1, -2, 0.5] }"
#define POINT "{ \"kind\": \"point\", \"intensity\": [3, 2, 1], \"position\": [0.8, 0.9, 0.2] }"

// `noise` are members of the density, `medium` of the medium beside it, `rest` of the job.
static void parse(struct job *job, double step, const char *noise, const char *medium, const char *rest)
{
    struct error error = {{0}};
    char text[4096];

    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"scene\", \"frames\": \"0-9\", \"fps\": 24, \"time_offset\": 1.5,"
             " \"resolution\": [%d, %d], \"camera\": { \"position\": [0.9, 0.4, -1.3], \"target\": [0.05, 0, 0],"
             " \"up\": [0.1, 1, 0], \"fov\": 40, \"clip\": [0.5, 2.5] },"
             " \"scene\": { \"media\": [ { \"density\": { \"kind\": \"noise\", %s }, %s } ] },"
             " \"quality\": { \"method\": \"midpoint\", \"step\": %.17g, \"light_step\": %.17g },"
             " \"output\": { \"path\": \"scene.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] }, %s }",
             WIDTH_PX, HEIGHT_PX, noise, medium, step, step, rest);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

struct truth {
    double radiance[3 * PIXELS], transmittance[3 * PIXELS];
};

static void find_truth(const struct job *job, double accuracy, struct truth *truth)
{
    struct still still;

    still_init(&still, job, job_frame_time(job, 0));
    assert_true(still.is_complete);
    for (int i = 0; i < PIXELS; i++) {
        struct reference_pixel pixel = reference_measure_pixel(&still, i % WIDTH_PX, i / WIDTH_PX,
                                                               &(struct integrate_accuracy){.relative = accuracy});

        memcpy(&truth->radiance[3 * i], pixel.radiance, sizeof pixel.radiance);
        memcpy(&truth->transmittance[3 * i], pixel.transmittance, sizeof pixel.transmittance);
    }
}

// The larger of the errors of radiance and transmittance.
static double error_on(enum gl_backend backend, const struct job *job, const struct truth *truth)
{
    static float radiance[3 * PIXELS], transmittance[3 * PIXELS];
    struct reference_error of_radiance, of_transmittance;
    struct image image;

    render_frame_on(backend, job, &image);
    for (int i = 0; i < 3 * PIXELS; i++) {
        radiance[i] = image.rgba[i / 3 * 4 + i % 3];
        transmittance[i] = image.transmittance[i / 3 * 4 + i % 3];
    }
    image_finish(&image);
    of_radiance = reference_image_error(radiance, truth->radiance, (size_t)3 * PIXELS);
    of_transmittance = reference_image_error(transmittance, truth->transmittance, (size_t)3 * PIXELS);
    print_message("step %.4f: relative RMSE %.2e, of transmittance %.2e\n", job->quality.step,
                  of_radiance.relative_rmse, of_transmittance.relative_rmse);
    return of_radiance.relative_rmse > of_transmittance.relative_rmse ? of_radiance.relative_rmse
                                                                      : of_transmittance.relative_rmse;
}

static void assert_true_light(double step, double tolerance, const char *noise, const char *medium, const char *rest)
{
    struct truth *truth = malloc(sizeof *truth);
    struct job job;

    parse(&job, step, noise, medium, rest);
    // Two halvings have to agree to the tolerance, and the second is far nearer to the truth than that.
    find_truth(&job, tolerance, truth);
    assert_true(error_on(GL_BACKEND_SOFTWARE, &job, truth) <= tolerance);
    assert_true(error_on(GL_BACKEND_EGL, &job, truth) <= tolerance);
    job_finish(&job);
    free(truth);
}

// Everything at once: four octaves that rotate about an oblique axis in a ball that moves, coloured media, two kinds of
// light, a background behind.
static void clipped_octaves_in_a_moving_ball(void **state)
{
    assert_true_light(
        0.01, 2e-3,
        "\"frequency\": 2.5, \"octaves\": 4, \"lacunarity\": 1.9, \"H\": 0.4, \"mode\": \"clip\","
        " \"offset\": [3.25, -0.5, 7], \"rotate\": { \"axis\": [0.2, 1, -0.3], \"angle\": { \"start\": 10, \"rate\": "
        "72 } },"
        " \"bounds\": { \"kind\": \"sphere\", \"center\": { \"start\": [0.1, 0, -0.2], \"rate\": [0, 0.05, 0] },"
        " \"radius\": 0.5, \"falloff\": 0.1 }, \"scale\": 2",
        "\"sigma_s\": [4, 6, 8], \"sigma_a\": [3, 1, 0], \"phase\": [ { \"g\": 0.6, \"weight\": 1 } ]",
        "\"lights\": [ " SUN ", " POINT " ], \"background\": [0.2, 0.3, 0.6]");
}

static void biased_turbulence_in_a_box(void **state)
{
    assert_true_light(0.01, 2e-3,
                      "\"frequency\": 3, \"octaves\": 3, \"H\": 0.7, \"bias\": { \"start\": 0, \"rate\": 0.2 },"
                      " \"mode\": \"absolute\", \"bounds\": { \"kind\": \"box\", \"center\": [0, 0.1, 0],"
                      " \"size\": [0.7, 0.6, 0.5] }",
                      "\"sigma_s\": [2, 4, 8], \"sigma_a\": 1", "\"lights\": [ " SUN " ]");
}

static void equal_octaves_before_a_background(void **state)
{
    assert_true_light(0.01, 2e-5, "\"frequency\": 2, \"octaves\": 2, \"H\": 0, \"bias\": -0.3, " BALL,
                      "\"sigma_s\": 0, \"sigma_a\": [2, 4, 8]", "\"lights\": [], \"background\": 1");
}

// Nothing bounds it but the camera's clip distances; a light of its own is inside.
static void endless_noise_around_a_light(void **state)
{
    assert_true_light(0.01, 2e-5, "\"frequency\": 1.5",
                      "\"sigma_s\": 1, \"sigma_a\": 0, \"phase\": [ { \"g\": 0.3, \"weight\": 1 } ]",
                      "\"lights\": [ " POINT " ]");
}

// Noise, falloff and light are smooth: half the steps, a quarter of the error.
static void error_falls_with_the_square_of_the_step(void **state)
{
    static const double STEPS[] = {0.08, 0.04, 0.02};
    struct truth *truth = malloc(sizeof *truth);
    double errors[3];

    for (int i = 0; i < 3; i++) {
        struct job job;

        parse(&job, STEPS[i], "\"frequency\": 2, " BALL, "\"sigma_s\": 4, \"sigma_a\": 1",
              "\"lights\": [ " SUN ", " POINT " ]");
        if (i == 0) find_truth(&job, 1e-4, truth);
        errors[i] = error_on(GL_BACKEND_SOFTWARE, &job, truth);
        job_finish(&job);
    }
    // First order would halve it; where rays only touch the ball coarse steps are worse than that.
    for (int i = 1; i < 3; i++)
        assert_true(errors[i - 1] / errors[i] > 3.0);
    free(truth);
}

// Where floats have no fractions an octave is 0, and coordinates beyond floats must not make it anything else.
static void octaves_too_fine_for_floats_are_zero(void **state)
{
    struct image one, all;
    struct job job;

    parse(&job, 0.1, "\"frequency\": 1e9, \"octaves\": 16, \"lacunarity\": 100, " BALL,
          "\"sigma_s\": 1, \"sigma_a\": 1", "\"lights\": [ " SUN " ]");
    render_frame_zero(&job, &all);
    job.scene.media[0].density.noise.octaves = 1;
    render_frame_zero(&job, &one);
    assert_true(all.transmittance[4 * (HEIGHT_PX / 2 * WIDTH_PX + WIDTH_PX / 2)] < 0.9f);
    assert_memory_equal(all.rgba, one.rgba, sizeof *one.rgba * 4 * PIXELS);
    job_finish(&job);
    image_finish(&all);
    image_finish(&one);
}

static char *fragment_of(const char *noise)
{
    struct scene_program program;
    struct job job;
    char *text;

    parse(&job, 0.1, noise, "\"sigma_s\": 0, \"sigma_a\": 1", "\"lights\": []");
    assert_true(scene_program_init(&program, &job, NULL, NULL, NULL));
    text = strdup(program.fragment);
    scene_program_finish(&program);
    job_finish(&job);
    return text;
}

static void neutral_numbers_add_no_code(void **state)
{
    static const char *const WORDS[] = {"_rotation", "shift",      "lacunarity", "gain",    "exponent", "_bias",
                                        "_clip(",    "_absolute(", "mat3",       "falloff", "clamp(q"};
    char *text = fragment_of("\"frequency\": 2, \"octaves\": 1, \"bias\": 0, \"offset\": [0, 0, 0],"
                             " \"rotate\": { \"axis\": [1, 0, 0], \"angle\": 0 }");

    for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; i++)
        if (strstr(text, WORDS[i])) fail_msg("expected no \"%s\" in the shader", WORDS[i]);
    free(text);
    text = fragment_of("\"frequency\": 2, \"octaves\": 2, \"H\": 0, \"mode\": \"clip\"");
    assert_non_null(strstr(text, "    q *= medium_0_lacunarity;\n    sum += density_noise(q);\n    return sum;"));
    assert_null(strstr(text, "remap"));
    free(text);
}

static void octaves_are_written_out(void **state)
{
    char *text = fragment_of("\"frequency\": 2, \"octaves\": 4, \"mode\": \"absolute\"");
    int count = 0;

    for (const char *at = text; (at = strstr(at, "density_noise_absolute(density_noise(q))")); ++at)
        ++count;
    assert_int_equal(count, 4);
    free(text);
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clipped_octaves_in_a_moving_ball),
        cmocka_unit_test(biased_turbulence_in_a_box),
        cmocka_unit_test(equal_octaves_before_a_background),
        cmocka_unit_test(endless_noise_around_a_light),
        cmocka_unit_test(error_falls_with_the_square_of_the_step),
        cmocka_unit_test(octaves_too_fine_for_floats_are_zero),
        cmocka_unit_test(neutral_numbers_add_no_code),
        cmocka_unit_test(octaves_are_written_out),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
