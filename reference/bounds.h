// The region to which a density is limited, and its falloff towards the faces.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"
#include "reference/box.h"
#include "reference/span_list.h"
#include "reference/vec3.h"

#include <stdbool.h>

struct bounds {
    enum scene_bounds_kind kind;
    struct vec3 center;
    double radius;      // of a sphere
    struct vec3 half;   // of a box: half its sides
    struct vec3 normal; // of a slab, of length 1
    double half_thickness;
    double falloff; // m; 0: none
};

// The stretch of the ray inside the region, within what `near` and `far` hold; false when it is empty.
bool bounds_clip(const struct bounds *bounds, const struct ray *ray, double *near, double *far);
// Distance to the nearest face, negative outside; INFINITY without bounds.
double bounds_depth(const struct bounds *bounds, struct vec3 position);
// The factor of the density: 0 outside.
double bounds_weight(const struct bounds *bounds, struct vec3 position);
// No factor in the box is above it.
double bounds_most(const struct bounds *bounds, const struct box *box);
// The box about the region; false: the region is endless.
bool bounds_extent(const struct bounds *bounds, struct box *box);
// Splits spans where the weight is not smooth: where the falloff starts and where another face becomes the nearest.
void bounds_split(const struct bounds *bounds, const struct ray *ray, struct span_list *spans);
