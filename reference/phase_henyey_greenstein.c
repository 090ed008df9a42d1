// SPDX-License-Identifier: Apache-2.0
#include "reference/phase_henyey_greenstein.h"

#include <math.h>

double phase_henyey_greenstein(double g, double cos_theta)
{
    double distance_squared = 1.0 + g * g - 2.0 * g * cos_theta;

    return (1.0 - g * g) / (4.0 * M_PI * distance_squared * sqrt(distance_squared));
}
