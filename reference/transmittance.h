// The transmittance of a stretch of a ray through media (Beer-Lambert).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/medium.h"

#include <stddef.h>

// The integral of the density, within about `tolerance`.
double transmittance_density_column(const struct density *density, const struct ray *ray, double near, double far,
                                    double tolerance);

// The tolerance of optical depths from which on one agreement of halvings is enough, as INTEGRATE_LOOSE.
#define TRANSMITTANCE_LOOSE 1.5e-5

// `optical_depth_tolerance` bounds the relative error of a transmittance that is not nearly 0.
void transmittance(const struct medium *media, size_t medium_count, const struct ray *ray, double near, double far,
                   double optical_depth_tolerance, double share[static 3]);

// `far`; or, if `far` and some media are infinite, the distance where these have absorbed all the light that they ever
// will, and the other media have ended.
double transmittance_reach(const struct medium *media, size_t medium_count, const struct ray *ray, double near,
                           double far);
