// Where a ray crosses the cones of a spot, between which its light fades.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/light.h"
#include "reference/span_list.h"
#include "reference/vec3.h"

#include <stdbool.h>

// Splits spans where the ray crosses the inner or the outer cone, at which the light's irradiance is not smooth. Other
// lights split nothing.
void spot_edges_split(const struct light *light, const struct ray *ray, struct span_list *spans);
// Shortens the stretch of the ray from `near` to `far`, both finite, to where it is in the outer cone, which is convex;
// false: nowhere.
bool spot_edges_clip(const struct light *spot, const struct ray *ray, double *near, double *far);
