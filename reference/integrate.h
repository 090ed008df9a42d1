// Integrates the light that reaches the start of a ray: emission and single scattering in media.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/still.h"

#include <stdbool.h>

// Radiance below which errors are absolute, unless `floor` says otherwise.
#define INTEGRATE_FLOOR 1e-6

// Zero means the default.
struct integrate_accuracy {
    double relative;   // error of the radiance against itself, of the transmittance against 1, per channel; 1e-4
    double floor;      // smaller radiances have the absolute error of one of this size; 1e-6
    int halving_limit; // halvings of one smooth stretch; 30
};

struct integrate_result {
    double radiance[3];      // without the light from behind `far`
    double transmittance[3]; // from near to far
    bool is_converged;       // false when halving_limit ended the refinement somewhere
};

// A straight piece of a ray within one region, whose media it crosses.
struct integrate_stretch {
    struct ray ray;
    double near, far; // m along the ray
    size_t region;
};

// Refines the densities along the ray, then the light that reaches it, each where its estimated error is largest, until
// the estimates are within the accuracy. Light that is too weak to count is left out. `accuracy` may be NULL.
struct integrate_result integrate_stretch(const struct still *still, const struct integrate_stretch *stretch,
                                          const struct integrate_accuracy *accuracy);
// The same for the media of the air alone.
struct integrate_result integrate_ray(const struct still *still, const struct ray *ray, double near, double far,
                                      const struct integrate_accuracy *accuracy);
