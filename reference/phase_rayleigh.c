// SPDX-License-Identifier: Apache-2.0
#include "reference/phase_rayleigh.h"

#include <math.h>

double phase_rayleigh(double cos_theta)
{
    return 3.0 / (16.0 * M_PI) * (1.0 + cos_theta * cos_theta);
}
