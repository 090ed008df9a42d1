// The transmittance of a stretch of a ray through media (Beer-Lambert).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/medium.h"

#include <stddef.h>

// The integral of the density, within about `tolerance`.
double transmittance_density_column(const struct density *density, const struct ray *ray, double near, double far,
                                    double tolerance);

// How exact a transmittance must be: one of the two is enough.
struct transmittance_accuracy {
    double optical_depth; // error of the optical depth, above 0: relative error of a transmittance
    double light;         // error of the transmittance itself; 0: none is allowed
};

// `share` is the transmittance of each channel.
void transmittance_within(const struct medium *media, size_t medium_count, const struct ray *ray, double near,
                          double far, const struct transmittance_accuracy *accuracy, double share[static 3]);
// The same within an error of the optical depth.
void transmittance(const struct medium *media, size_t medium_count, const struct ray *ray, double near, double far,
                   double optical_depth_tolerance, double share[static 3]);

// `far`; or, if `far` and some media are infinite, the distance where these have absorbed all the light that they ever
// will, and the other media have ended.
double transmittance_reach(const struct medium *media, size_t medium_count, const struct ray *ray, double near,
                           double far);
