// Random directions towards a dome, many where it is bright.
// SPDX-License-Identifier: Apache-2.0
// Directions of an image are drawn by the mean of the three colours over a texel, and evenly within the texel; those of
// a gradient by its mean colour; those of a black dome evenly. Pharr, Jakob and Humphreys, Physically Based Rendering,
// 4th edition 2023, section 12.5.
#pragma once

#include "reference/dome.h"

struct dome_sampler {
    const struct dome *dome; // borrowed; outlives us
    double *sums;            // owned; of a row's texels up to each, then of the rows: what an image brings; NULL: none
    double *row_sums;        // the last part of `sums`
};

// The caller passes `sampler` to dome_sampler_finish, which accepts the zero value.
void dome_sampler_init(struct dome_sampler *sampler, const struct dome *dome);
void dome_sampler_finish(struct dome_sampler *sampler);
// A direction towards the dome, of length 1; `u` is even in [0, 1)^4.
struct vec3 dome_sampler_draw(const struct dome_sampler *sampler, const double u[static 4]);
// The density of these directions, per steradian; above 0 wherever the dome is not black.
double dome_sampler_density(const struct dome_sampler *sampler, struct vec3 toward);
