// Gathers the light that reaches the start of a ray: emission and single scattering in media.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/still.h"

#include <stdbool.h>

// A relative accuracy from which on one agreement is taken for no accident, and light behind a thousandth of it for none.
#define INTEGRATE_LOOSE 2e-4

// Zero means the default.
struct integrate_accuracy {
    double relative;   // error of the radiance against itself, of the transmittance against 1, per channel; 1e-4
    double floor;      // a radiance below it is as accurate as one of this size; 1e-6
    int halving_limit; // of one smooth stretch; 30
};

struct integrate_result {
    double radiance[3];      // without what lies behind
    double transmittance[3]; // from near to far
    bool is_converged;       // false when the limit of halvings ended the refinement somewhere
};

// A straight piece of a ray in one region, whose media it passes.
struct integrate_stretch {
    struct ray ray;
    double near, far; // m along the ray
    size_t region;
};

// Each smooth stretch is halved until two halvings in a row agree to its share of the accuracy; one is enough where less than
// INTEGRATE_LOOSE is asked for, as by audits, whose error is a mean over many pixels. `accuracy` may be NULL.
struct integrate_result integrate_stretch(const struct still *still, const struct integrate_stretch *stretch,
                                          const struct integrate_accuracy *accuracy);
// The same through air alone.
struct integrate_result integrate_ray(const struct still *still, const struct ray *ray, double near, double far,
                                      const struct integrate_accuracy *accuracy);
