// SPDX-License-Identifier: Apache-2.0
#include "worker/sheet/exposure.h"

#include "worker/picture/image.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static const double PERCENTILE = 0.99, TARGET = 0.8;
// The bins are the upper bits of a float: sign, exponent and the start of the mantissa.
enum { DROPPED_BITS = 16 };

void exposure_add(struct exposure *exposure, float luminance)
{
    uint32_t bits;

    if (!isfinite(luminance)) return;
    if (luminance <= 0) {
        exposure->dark++;
        return;
    }
    memcpy(&bits, &luminance, sizeof bits);
    exposure->counts[bits >> DROPPED_BITS]++;
    exposure->lit++;
}

float exposure_luminance(float red, float green, float blue)
{
    return 0.2126f * red + 0.7152f * green + 0.0722f * blue;
}

void exposure_add_image(struct exposure *exposure, const struct image *image)
{
    size_t count = (size_t)image->width_px * (size_t)image->height_px;

    for (size_t i = 0; i < count; i++) {
        const float *pixel = image->rgba + i * 4;

        exposure_add(exposure, exposure_luminance(pixel[0], pixel[1], pixel[2]));
    }
}

static double bin_middle(size_t bin)
{
    uint32_t bits = (uint32_t)bin << DROPPED_BITS | 1u << (DROPPED_BITS - 1);
    float value;

    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

double exposure_choose(const struct exposure *exposure)
{
    double below = PERCENTILE * (double)(exposure->dark + exposure->lit) - (double)exposure->dark;
    double seen = 0;

    if (exposure->lit == 0) return 0;
    if (below <= 0) below = PERCENTILE * (double)exposure->lit;
    for (size_t bin = 0; bin < sizeof exposure->counts / sizeof exposure->counts[0]; bin++) {
        seen += (double)exposure->counts[bin];
        if (seen >= below && exposure->counts[bin]) return log2(TARGET / bin_middle(bin));
    }
    return 0;
}
