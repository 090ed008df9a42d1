// The weights by which audits draw pixels of a frame: how bright a pixel is, how far it stands out, what it has lost.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

struct image;

// The mean of the squares of a pixel's colours.
double audit_weight_square(const struct image *image, size_t pixel);
// The squared distance of a pixel's colours, in the mean, from the range of the four pixels two away. An edge lies
// within that range, in either direction: a pixel outside it is a thin line or a mistake.
double audit_weight_spike(const struct image *image, size_t pixel);

// The square of the throughput of a pixel's cut rays; 0 where the image does not have it.
double audit_weight_cut(const struct image *image, size_t pixel);

struct audit_weight_row {
    double squares, spikes, cuts; // sums over the row
    float brightest;              // the largest colour; -INFINITY or more; NaN does not count
};

// Sums of the weights over row `y`, as the functions above have them, to rounding.
struct audit_weight_row audit_weight_row(const struct image *image, int y);
