// SPDX-License-Identifier: Apache-2.0
#include "tests/support/sparse_pair.h"

#include "core/base/error.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

struct image sparse_pair_frame(struct renderer *renderer, const struct job *job, int32_t frame,
                               struct job_pixels pixels, struct renderer_result *result)
{
    struct job changed = *job;
    struct error error = {{0}};
    struct image image = {0};

    changed.quality.pixels = pixels;
    if (!image_init_for_job(&image, job, &error) || !image_ask_cut(&image, &error)) fail_msg("%s", error.message);
    memset(image.cut, 1, (size_t)image.width_px * (size_t)image.height_px * sizeof *image.cut); // not 0 by chance
    if (!renderer_render(renderer, &(struct renderer_frame){.job = &changed, .frame = frame, .image = &image}, result,
                         &error))
        fail_msg("%s", error.message);
    return image;
}

void sparse_pair_render(struct renderer *renderer, const struct job *job, int32_t frame, struct job_pixels pixels,
                        struct sparse_pair *pair)
{
    pair->full = sparse_pair_frame(renderer, job, frame, (struct job_pixels){0}, &pair->full_result);
    pair->sparse = sparse_pair_frame(renderer, job, frame, pixels, &pair->sparse_result);
}

void sparse_pair_finish(struct sparse_pair *pair)
{
    image_finish(&pair->full);
    image_finish(&pair->sparse);
}

double sparse_pair_error(const struct sparse_pair *pair)
{
    double apart = 0.0, light = 0.0;

    for (size_t i = 0; i < 4 * (size_t)pair->full.width_px * (size_t)pair->full.height_px; i++) {
        double known = (double)pair->full.rgba[i], off = (double)pair->sparse.rgba[i] - known;

        if (i % 4 == 3) continue;
        apart += off * off;
        light += known * known;
    }
    return sqrt(apart / light);
}
