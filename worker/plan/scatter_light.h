// What the light of some pixels, known in two halves, says of its own noise. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

struct truth_pixel;

// The mean square of the light, as the product of its halves; not below 0.
double scatter_light_square(const struct truth_pixel *pixels, size_t count);
// How many pixels of equal brightness would have the same sums of squares and of fourth powers.
double scatter_light_count(const struct truth_pixel *pixels, size_t count);
