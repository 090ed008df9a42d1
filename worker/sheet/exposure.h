// Finds one exposure for a sequence of pictures, so that they can be compared.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct image;

// A histogram of luminance; the zero value is empty. A bin is 1/128 wide, relative to its luminance.
struct exposure {
    uint64_t counts[1 << 15]; // by the upper bits of the luminance as a float
    uint64_t dark;            // luminance 0 and below
    uint64_t lit;
};

void exposure_add(struct exposure *exposure, float luminance); // one that is not finite is left out
float exposure_luminance(float red, float green, float blue);
void exposure_add_image(struct exposure *exposure, const struct image *image);
// Returns the stops that bring the 99th percentile of the luminance to 0.8: the percentile of all pixels or, where that
// is black, of those that are not. 0 when every pixel is black.
double exposure_choose(const struct exposure *exposure);
