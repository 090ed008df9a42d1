// SPDX-License-Identifier: Apache-2.0
#include "tests/support/true_error.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/random.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

enum { MOST = 4096 }; // pixels that are measured

double true_error_measure(const struct job *job, int32_t frame, const struct image *image)
{
    static const double BLACK = 1e-6, TRULY = 2e-4;
    // A twentieth of what the picture may be off adds a thousandth to its error.
    const struct integrate_accuracy accuracy = {.relative = fmax(TRULY, job->quality.tolerance / 20.0)};
    struct error error = {{0}};
    struct truth *truth = truth_open(&(struct truth_params){.job = job, .frame = frame}, &error);
    size_t pixel_count = (size_t)job->width_px * (size_t)job->height_px;
    size_t count = pixel_count < MOST ? pixel_count : MOST;
    struct random random = {.state = 1};
    struct pixel *places = xcalloc(count, sizeof *places);
    struct truth_pixel *pixels = xcalloc(count, sizeof *pixels);
    double apart = 0.0, light = 0.0;

    if (!truth) fail_msg("%s", error.message);
    for (size_t i = 0; i < count; ++i) {
        size_t at = count == pixel_count ? i : (size_t)random_between(&random, 0.0, (double)pixel_count);

        places[i] = (struct pixel){(int)(at % (size_t)job->width_px), (int)(at / (size_t)job->width_px)};
    }
    truth_measure_many(truth,
                       &(struct truth_many){.points = places, .pixels = pixels, .count = count, .accuracy = &accuracy});
    for (size_t i = 0; i < 3 * count; ++i) {
        double known = pixels[i / 3].rgb[i % 3];
        struct pixel place = places[i / 3];
        size_t at = (size_t)place.y * (size_t)job->width_px + (size_t)place.x;
        double seen = image_exr_stored(image->rgba[4 * at + i % 3], job->output.pixel);

        apart += (seen - known) * (seen - known);
        light += known * known;
    }
    truth_close(truth);
    free(places);
    free(pixels);
    light /= 3.0 * (double)count;
    apart /= 3.0 * (double)count;
    return sqrt(light > BLACK * BLACK ? apart / light : apart);
}
