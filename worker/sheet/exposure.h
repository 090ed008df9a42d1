// The exposure that shows a sequence of pictures well: one for all of them, so that they can be compared.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct image;

// The zero value has seen nothing. Luminance is counted to within 1/128.
struct exposure {
    uint64_t counts[1 << 15]; // of luminances whose float begins with these bits
    uint64_t dark;            // luminance 0 and below
    uint64_t lit;
};

void exposure_add_image(struct exposure *exposure, const struct image *image);
// Stops that take the 99th percentile of the luminance to 0.8: of all pixels, or, where that is black, of those that
// are not. 0 when every pixel is black.
double exposure_choose(const struct exposure *exposure);
