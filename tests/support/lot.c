// SPDX-License-Identifier: Apache-2.0
#include "tests/support/lot.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

// A black light moves, so that no two frames share their random numbers.
void lot_parse(struct job *job, const struct lot_scene *scene)
{
    struct error error = {{0}};
    char text[8192];

    snprintf(
        text, sizeof text,
        "{ \"version\": 1, \"name\": \"lot\", \"frames\": \"0-9999\", \"fps\": 24, \"resolution\": [%d, %d],"
        " \"camera\": { \"position\": [0.1, 0.2, 4], \"target\": [0, 0, 0], \"fov\": 30 }, \"background\": %s,"
        " \"lights\": [ %s { \"kind\": \"point\", \"intensity\": 0, \"position\": { \"start\": [0, 9, 0],"
        " \"rate\": [1, 0, 0] } } ], \"scene\": { \"media\": [ %s ] }, \"quality\": { %s },"
        " \"output\": { \"path\": \"lot.####.exr\", \"pixel\": \"float\", \"aovs\": [\"Z\", \"transmittance\"] } }",
        LOT_WIDTH_PX, LOT_HEIGHT_PX, scene->background ? scene->background : "0.3", scene->lights ? scene->lights : "",
        scene->media, scene->quality);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

void lot_find_truth(const struct lot_scene *scene, double truth[static LOT_VALUES])
{
    static const struct integrate_accuracy accuracy = {.relative = 3e-4};
    struct error error = {{0}};
    struct truth *exact;
    struct job job;

    lot_parse(&job, scene);
    exact = truth_open(&(struct truth_params){.job = &job}, &error);
    if (!exact) fail_msg("%s", error.message);
    for (int i = 0; i < LOT_VALUES / 3; ++i) {
        struct truth_pixel pixel = truth_measure(exact, i % LOT_WIDTH_PX, i / LOT_WIDTH_PX, &accuracy);

        memcpy(truth + 3 * (size_t)i, pixel.rgb, sizeof pixel.rgb);
    }
    truth_close(exact);
    job_finish(&job);
}

struct sums {
    double first[LOT_VALUES], second[LOT_VALUES]; // of values and of their squares
    double wholes[2];                             // of the frames' means and of their squares
};

static void add(struct sums *sums, const struct image *image, const double *truth)
{
    double whole = 0;

    for (size_t i = 0; i < LOT_VALUES; ++i) {
        double off = (double)image->rgba[i / 3 * 4 + i % 3] - truth[i];

        sums->first[i] += off;
        sums->second[i] += off * off;
        whole += off / LOT_VALUES;
    }
    sums->wholes[0] += whole;
    sums->wholes[1] += whole * whole;
}

static void render(struct sums *sums, const struct lot_scene *scene, const double *truth, int frames)
{
    struct error error = {{0}};
    struct gl_stage stage = gl_stage_open(GL_BACKEND_OSMESA, test_shader_dir());
    struct image image;
    struct job job;

    lot_parse(&job, scene);
    assert_true(image_init(&image, LOT_WIDTH_PX, LOT_HEIGHT_PX, true, true, NULL));
    for (int32_t frame = 0; frame < frames; ++frame) {
        struct renderer_result result;

        if (!renderer_render(stage.renderer, &job, frame, &image, NULL, NULL, &result, &error))
            fail_msg("%s", error.message);
        add(sums, &image, truth);
    }
    image_finish(&image);
    gl_stage_close(stage);
    job_finish(&job);
}

struct lot_errors lot_measure(const struct lot_scene *scene, const double truth[static LOT_VALUES], int frames)
{
    struct sums sums = {0};
    struct lot_errors errors = {0};
    double mean = 0, bias, square = 0, variance = 0;

    render(&sums, scene, truth, frames);
    for (size_t i = 0; i < LOT_VALUES; ++i) {
        double off = sums.first[i] / frames;

        mean += truth[i] / LOT_VALUES;
        square += off * off / LOT_VALUES;
        variance += (sums.second[i] / frames - off * off) / LOT_VALUES;
    }
    bias = sums.wholes[0] / frames;
    errors.bias = bias / mean;
    errors.sigmas = bias / sqrt(fmax((sums.wholes[1] / frames - bias * bias) / (frames - 1), 1e-30));
    errors.chance = square / fmax(variance / (frames - 1), 1e-30);
    errors.spread = sqrt(fmax(variance, 0)) / mean;
    print_message("%.70s: bias %+.1e, %+.1f standard errors, chance %.2f, spread %.2f\n", scene->quality, errors.bias,
                  errors.sigmas, errors.chance, errors.spread);
    return errors;
}
