// Which share of a light's irradiance arrives straight through media and dielectrics.
// SPDX-License-Identifier: Apache-2.0
// Each boundary takes what it reflects. Nothing is bent, and nothing opaque lets anything through.
#pragma once

#include "reference/still.h"

// From the ray's origin to `distance`, which may be INFINITY; the tolerance is that of transmittance().
void light_walk(const struct still *still, const struct ray *ray, double distance, double optical_depth_tolerance,
                double share[static 3]);
