// SPDX-License-Identifier: Apache-2.0
#include "tests/support/bias_check.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "reference/paths.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "worker/audit/truth.h"
#include "worker/audit/truth_files.h"
#include "worker/picture/image.h"
#include "worker/picture/pixel.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

// A black light moves, so that no two frames share their random numbers.
void bias_check_parse(struct job *job, const struct bias_check_scene *scene)
{
    bool has_background = !scene->background || *scene->background;
    struct error error = {{0}};
    char text[8192];

    snprintf(
        text, sizeof text,
        "{ \"version\": 1, \"name\": \"bias\", \"frames\": \"0-9999\", \"fps\": 24, \"resolution\": [%d, %d],"
        " \"camera\": { \"position\": [0.1, 0.2, 4], \"target\": [0, 0, 0], \"fov\": 30 }, %s%s%s"
        " \"lights\": [ %s { \"kind\": \"point\", \"intensity\": 0, \"position\": { \"start\": [0, 9, 0],"
        " \"rate\": [1, 0, 0] } } ], \"scene\": { \"scattering\": { \"orders\": %s }, \"media\": [ %s ],"
        " \"objects\": [ %s ] },"
        " \"quality\": { %s },"
        " \"output\": { \"path\": \"bias.####.exr\", \"pixel\": \"float\", \"aovs\": [\"Z\", \"transmittance\"] } }",
        BIAS_CHECK_WIDTH_PX, BIAS_CHECK_HEIGHT_PX, has_background ? "\"background\": " : "",
        scene->background ? scene->background : "0.3", has_background ? "," : "", scene->lights ? scene->lights : "",
        scene->orders ? scene->orders : "1", scene->media, scene->objects ? scene->objects : "", scene->quality);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

void bias_check_find_truth(const struct bias_check_scene *scene, double truth[static BIAS_CHECK_VALUES])
{
    static const struct integrate_accuracy accuracy = {.relative = 3e-4};
    struct error error = {{0}};
    struct truth *exact;
    struct job job;

    bias_check_parse(&job, scene);
    exact = truth_open(&(struct truth_params){.job = &job}, &error);
    if (!exact) fail_msg("%s", error.message);
    for (int i = 0; i < BIAS_CHECK_VALUES / 3; ++i) {
        struct truth_pixel pixel = truth_measure(exact, i % BIAS_CHECK_WIDTH_PX, i / BIAS_CHECK_WIDTH_PX, &accuracy);

        memcpy(truth + 3 * (size_t)i, pixel.rgb, sizeof pixel.rgb);
    }
    truth_close(exact);
    job_finish(&job);
}

void bias_check_find_job_paths(const struct job *job, long count, double truth[static BIAS_CHECK_VALUES],
                               double errors[static BIAS_CHECK_VALUES])
{
    struct error error = {{0}};
    struct truth_files files = {0};
    struct paths *paths;
    struct still still;

    if (!truth_files_load(&files, job, 0, &error)) fail_msg("%s", error.message);
    still_init_with_inputs(&still, job, 0, &files.inputs);
    paths = paths_create(&still, job->scene.orders, &error);
    if (!paths) fail_msg("%s", error.message);
    for (int i = 0; i < BIAS_CHECK_VALUES / 3; ++i) {
        struct paths_light light;

        paths_measure_point(paths, i % BIAS_CHECK_WIDTH_PX + 0.5, i / BIAS_CHECK_WIDTH_PX + 0.5, count, (uint64_t)i,
                            &light);
        memcpy(truth + 3 * (size_t)i, light.mean, sizeof light.mean);
        memcpy(errors + 3 * (size_t)i, light.error, sizeof light.error);
    }
    paths_destroy(paths);
    truth_files_finish(&files);
}

void bias_check_find_paths(const struct bias_check_scene *scene, long count, double truth[static BIAS_CHECK_VALUES],
                           double errors[static BIAS_CHECK_VALUES])
{
    struct job job;

    bias_check_parse(&job, scene);
    bias_check_find_job_paths(&job, count, truth, errors);
    job_finish(&job);
}

// The truth's variance: of its mean over all values, and the mean of those of its values. A pixel's colours share its
// paths.
static void find_noise(const double *noise, double *of_mean, double *mean)
{
    *of_mean = *mean = 0;
    for (size_t i = 0; noise && i < BIAS_CHECK_VALUES; i += 3) {
        double sum = noise[i] + noise[i + 1] + noise[i + 2];

        *of_mean += sum * sum / ((double)BIAS_CHECK_VALUES * BIAS_CHECK_VALUES);
        for (size_t c = 0; c < 3; ++c)
            *mean += noise[i + c] * noise[i + c] / BIAS_CHECK_VALUES;
    }
}

struct sums {
    double first[BIAS_CHECK_VALUES], second[BIAS_CHECK_VALUES]; // of values and of their squares
    double wholes[2];                                           // of the frames' means and of their squares
};

static void add(struct sums *sums, const struct image *image, const double *truth)
{
    double whole = 0;

    for (size_t i = 0; i < BIAS_CHECK_VALUES; ++i) {
        double off = (double)image->rgba[i / 3 * 4 + i % 3] - truth[i];

        sums->first[i] += off;
        sums->second[i] += off * off;
        whole += off / BIAS_CHECK_VALUES;
    }
    sums->wholes[0] += whole;
    sums->wholes[1] += whole * whole;
}

static void render(struct sums *sums, const struct job *job, const double *truth, int frames)
{
    struct error error = {{0}};
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct pixel pixels[BIAS_CHECK_VALUES / 3];
    struct image image;

    for (int i = 0; i < BIAS_CHECK_VALUES / 3; ++i)
        pixels[i] = (struct pixel){i % BIAS_CHECK_WIDTH_PX, i / BIAS_CHECK_WIDTH_PX};
    assert_true(image_init(&image, BIAS_CHECK_WIDTH_PX, BIAS_CHECK_HEIGHT_PX, true, true, NULL));
    for (int32_t frame = 0; frame < frames; ++frame) {
        struct renderer_result result;

        if (!renderer_render(stage.renderer,
                             &(struct renderer_frame){.job = job,
                                                      .frame = frame,
                                                      .pixels = job->quality.pixels.stride > 0 ? pixels : NULL,
                                                      .pixel_count = BIAS_CHECK_VALUES / 3,
                                                      .image = &image},
                             &result, &error))
            fail_msg("%s", error.message);
        add(sums, &image, truth);
    }
    image_finish(&image);
    gl_stage_close(stage);
}

struct bias_check_errors bias_check_measure_job(const struct job *job, const double truth[static BIAS_CHECK_VALUES],
                                                const double *noise, int frames)
{
    struct sums sums = {0};
    struct bias_check_errors errors = {0};
    double mean = 0, bias, square = 0, variance = 0, noise_of_mean, own;

    render(&sums, job, truth, frames);
    for (size_t i = 0; i < BIAS_CHECK_VALUES; ++i) {
        double off = sums.first[i] / frames;

        mean += truth[i] / BIAS_CHECK_VALUES;
        square += off * off / BIAS_CHECK_VALUES;
        variance += (sums.second[i] / frames - off * off) / BIAS_CHECK_VALUES;
    }
    find_noise(noise, &noise_of_mean, &own);
    bias = sums.wholes[0] / frames;
    errors.bias = bias / mean;
    errors.sigmas = bias / sqrt(fmax((sums.wholes[1] / frames - bias * bias) / (frames - 1) + noise_of_mean, 1e-30));
    errors.chance = square / fmax(variance / (frames - 1) + own, 1e-30);
    errors.spread = sqrt(fmax(variance, 0)) / mean;
    return errors;
}

struct bias_check_errors bias_check_measure(const struct bias_check_scene *scene,
                                            const double truth[static BIAS_CHECK_VALUES], int frames)
{
    struct bias_check_errors errors;
    struct job job;

    bias_check_parse(&job, scene);
    errors = bias_check_measure_job(&job, truth, scene->noise, frames);
    job_finish(&job);
    print_message("%.70s: bias %+.1e, %+.1f standard errors, chance %.2f, spread %.2f\n", scene->quality, errors.bias,
                  errors.sigmas, errors.chance, errors.spread);
    return errors;
}
