// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/scatter_light.h"

#include "worker/audit/truth.h"

#include <math.h>

double scatter_light_square(const struct truth_pixel *pixels, size_t count)
{
    double sum = 0.0;

    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            sum += pixels[i].rgb[c] * pixels[i].rgb[c] - pixels[i].half[c] * pixels[i].half[c];
    return fmax(sum / (3.0 * (double)count), 0.0);
}

double scatter_light_count(const struct truth_pixel *pixels, size_t count)
{
    double squares = 0.0, fourths = 0.0;

    for (size_t i = 0; i < count; i++) {
        double square = scatter_light_square(&pixels[i], 1);

        squares += square;
        fourths += square * square;
    }
    return fourths > 0.0 ? squares * squares / fourths : (double)count;
}
