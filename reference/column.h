// The integral of a density along a ray.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/density.h"

// How exact a column must be: one of the two is enough.
struct column_accuracy {
    double error; // of the column; above 0
    // The error of exp(-sigma column), the light that passes, for each sigma between sigma_min and sigma_max. 0: the
    // column alone counts.
    double light, sigma_min, sigma_max;
};

// The integral of the density from `near` to `far`, refined until its estimated error is as small as asked.
double column_integrate(const struct density *density, const struct ray *ray, double near, double far,
                        const struct column_accuracy *accuracy);
