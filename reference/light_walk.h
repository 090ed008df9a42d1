// The share of a light's irradiance that arrives in a straight line through media and dielectrics.
// SPDX-License-Identifier: Apache-2.0
// Each boundary takes the share that it reflects. Rays are not refracted. Opaque objects block all light.
#pragma once

#include "reference/still.h"
#include "reference/transmittance.h"

// From the ray's origin to `distance`, which may be INFINITY; `share` is as exact as the accuracy asks.
void light_walk(const struct still *still, const struct ray *ray, double distance,
                const struct transmittance_accuracy *accuracy, double share[static 3]);
