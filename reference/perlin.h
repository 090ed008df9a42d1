// Perlin's improved noise at several points at once. Perlin, Improving Noise, SIGGRAPH 2002.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

enum { PERLIN_BATCH = 16 };

// The noise at up to PERLIN_BATCH points, in lattice cells. A point's value does not depend on the others. It is 0
// where all three coordinates are integers, and has period 256 in each.
void perlin_noise(size_t count, const double *x, const double *y, const double *z, double *values);
// The same to the last bit, by instructions that every processor has.
void perlin_noise_plain(size_t count, const double *x, const double *y, const double *z, double *values);
