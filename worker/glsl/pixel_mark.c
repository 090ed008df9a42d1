// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/pixel_mark.h"

#include "core/base/error.h"
#include "core/job/job.h"

#include <math.h>

// A mean over samples of which only one is marked is smaller by their number, which is less than the factor.
static enum pixel_mark read_mark(float alpha, int *medium)
{
    if (alpha > 0.9f / JOB_SAMPLE_LIMIT * PIXEL_MARK_MAJORANT) return PIXEL_MARK_IS_CUT;
    *medium =
        (int)ceil(log(fabs((double)alpha) / fabs((double)PIXEL_MARK_MAJORANT)) / log((double)PIXEL_MARK_FACTOR) - 0.02);
    return PIXEL_MARK_IS_MAJORANT;
}

enum pixel_mark pixel_mark_find(const float *rgba, size_t count, size_t *at, int *medium)
{
    for (*at = 0; *at < count; ++*at)
        if (rgba[4 * *at + 3] < PIXEL_MARK_LEAST) return read_mark(rgba[4 * *at + 3], medium);
    return PIXEL_MARK_IS_NONE;
}

void pixel_mark_tell_majorant(const struct scene *scene, int medium, struct error *error)
{
    char place[64];

    scene_format_medium_place(scene, (size_t)medium, place, sizeof place);
    error_set(error, "%s.density.majorant: expected an upper bound of density(), got %g, which it exceeds", place,
              scene->media[medium].density.glsl.majorant);
}
