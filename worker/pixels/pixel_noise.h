// How far the noise of random paths explains what differs between the points of a lattice.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

// A plane of noise has 4 floats a point, of which three count: a draw from the distribution of each channel's noise, by
// which it is off from its mean; half the difference between the means of two halves of its paths is one. A standard
// deviation may stand in its place.

// Replaces the values by standard deviations: the root mean square of the values of a point and those around it.
void pixel_noise_pool(float *plane, int columns, int rows);
// A row of the lattice: doubts that five standard deviations of the bend (pixel_spread.h) explain become 1 at most,
// for which nothing is traced. `noise` has standard deviations, `scale` times which is a doubt.
void pixel_noise_lower(const float *noise, float scale, int columns, float *doubt);
// True where a traced point's noise, with the standard deviations `noise`, and that of the points around explain that
// it is `off` from what was expected of it.
bool pixel_noise_explains(const float *noise, float off);
