// What interpolated pixels add to a frame's error, as audits estimate it: how often the bound holds.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/example_job.h"
#include "tests/support/gl_stage.h"
#include "worker/picture/image.h"
#include "worker/plan/pixel_audit.h"
#include "worker/plan/plan_params.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { FRAMES = 6, THRESHOLDS = 3 };

static const double COVERED = 0.93;                              // share of the bounds that hold at least
static const double THRESHOLD[THRESHOLDS] = {0.003, 0.01, 0.05}; // relative to the picture's RMS
static const struct job_quality CACHED = {.method = JOB_METHOD_CACHED, .step = 0.04, .light_grid = 48, .samples = 1};
static const struct job_quality EVEN = {.method = JOB_METHOD_EQUIANGULAR, .points = 4, .samples = 1};

static const struct {
    const char *name;
    const struct job_quality *quality;
} examples[] = {{"cloud", &CACHED}, {"noise", &CACHED}, {"fog", &EVEN}, {"sunset", &EVEN}};

static const char *only; // the one example's name; NULL: all

struct tally {
    int count, covered;
    double ratios; // sum of the logarithms of estimate over truth
};

static void render(struct gl_stage stage, const struct job *job, int32_t frame, struct image *image)
{
    struct renderer_result result;
    struct error error = {{0}};

    if (!renderer_render(stage.renderer, &(struct renderer_frame){.job = job, .frame = frame, .image = image}, &result,
                         &error))
        fail_msg("%s", error.message);
}

// The RMS of the difference, relative to that of the traced picture.
static double find_error(const struct image *image, const struct image *traced)
{
    size_t count = 4 * (size_t)image->width_px * (size_t)image->height_px;
    double squares = 0.0, light = 0.0;

    for (size_t i = 0; i < count; i++) {
        double difference = (double)image->rgba[i] - traced->rgba[i];

        if (i % 4 == 3) continue;
        squares += difference * difference;
        light += (double)traced->rgba[i] * traced->rgba[i];
    }
    return sqrt(squares / light);
}

static void audit(struct gl_stage stage, const struct job *job, int32_t frame, const struct image *traced,
                  struct tally *tally)
{
    const struct plan_params params = {.renderer = stage.renderer, .job = job};
    struct audit_verdict verdict;
    enum renderer_fault fault;
    struct error error = {{0}};
    struct image image;
    double truth;

    if (!image_init_for_job(&image, job, &error)) fail_msg("%s", error.message);
    render(stage, job, frame, &image);
    assert_non_null(image.doubts);
    if (!pixel_audit_measure(&(struct pixel_audit){.params = &params, .planned = job, .frame = frame, .image = &image},
                             &verdict, &fault, &error))
        fail_msg("%s", error.message);
    truth = find_error(&image, traced);
    tally->count++;
    tally->covered += verdict.error95 >= truth;
    tally->ratios += log(fmax(verdict.error, 1e-9) / truth);
    image_finish(&image);
}

static void bounds_hold(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct tally tally = {0};

    for (size_t i = 0; i < sizeof examples / sizeof *examples; i++) {
        struct job job;
        struct error error = {{0}};
        struct image traced;

        if (only && strcmp(examples[i].name, only) != 0) continue;
        example_job_load(&job, examples[i].name);
        job.width_px = 640;
        job.height_px = 360;
        job.output.pixel = JOB_PIXEL_FLOAT;
        job.quality = *examples[i].quality;
        if (!image_init_for_job(&traced, &job, &error)) fail_msg("%s", error.message);
        for (int32_t frame = 0; frame < FRAMES; frame++) {
            job.quality.pixels = (struct job_pixels){0};
            render(stage, &job, 7 * frame, &traced);
            for (int k = 0; k < THRESHOLDS; k++) {
                job.quality.pixels = (struct job_pixels){.stride = 16, .threshold = THRESHOLD[k]};
                audit(stage, &job, 7 * frame, &traced, &tally);
            }
        }
        image_finish(&traced);
        job_finish(&job);
    }
    gl_stage_close(stage);
    print_message("%d of %d bounds hold; estimates are %.2f of the truth in the geometric mean\n", tally.covered,
                  tally.count, exp(tally.ratios / tally.count));
    assert_true(tally.covered >= COVERED * tally.count);
    assert_true(fabs(tally.ratios / tally.count) < log(1.25));
}

// One argument: the one example to be looked at.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(bounds_hold)};

    if (argc > 1) only = argv[1];
    return cmocka_run_group_tests(tests, NULL, NULL);
}
