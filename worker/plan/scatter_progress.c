// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/scatter_progress.h"

#include "worker/audit/truth.h"
#include "worker/plan/plan_progress.h"
#include "worker/plan/plan_small.h"

// Pictures that take half of the time for all: nobody knows how many there will be.
static const double HALF_OF_PICTURES = 6.0;

void scatter_progress_begin_light(struct scatter_progress *progress, double share, const struct truth_pixel *pixels,
                                  size_t count)
{
    progress->begun += progress->part;
    progress->part = share;
    progress->pixels = pixels;
    progress->count = count;
    progress->done = 0.0;
}

// Of the pixels that are lit: those beside a cloud are measured at once.
static double find_done(const struct scatter_progress *progress)
{
    double lit = 0.0, all = 0.0;

    for (size_t i = 0; i < progress->count; i++) {
        const double *rgb = progress->pixels[i].rgb;

        if (rgb[0] + rgb[1] + rgb[2] <= 0.0) continue;
        all++;
        lit += (double)i < progress->done * (double)progress->count;
    }
    return all > 0.0 ? lit / all : progress->done;
}

bool scatter_progress_on_pixel(void *user)
{
    const struct scatter_progress *progress = user;

    plan_progress_note(progress->params, PLAN_STAGE_LIGHT, progress->begun + progress->part * find_done(progress));
    return plan_small_on_pixel((void *)progress->params);
}

void scatter_progress_count_picture(struct scatter_progress *progress)
{
    double count = ++progress->picture_count;

    plan_progress_note(progress->params, PLAN_STAGE_PATHS, count / (count + HALF_OF_PICTURES));
}
