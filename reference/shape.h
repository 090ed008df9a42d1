// Convex solids in closed form: the stretch of a ray inside, and the normal of the boundary.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"
#include "reference/vec3.h"

#include <stdbool.h>

struct shape {
    enum scene_shape_kind kind;
    struct vec3 center; // of a plane: any point of it
    double radius;      // of a sphere
    struct vec3 half;   // of a box: half its sides
    struct vec3 normal; // of a plane, of length 1; the solid lies behind it
};

// The stretch of the ray inside the solid, ahead of the origin; `end` may be INFINITY. False when there is none. An
// origin on the boundary, to within rounding, counts as inside if the ray goes inwards.
bool shape_cross(const struct shape *shape, const struct ray *ray, double *begin, double *end);
// The outward normal, of length 1, at the boundary's point nearest to `position`.
struct vec3 shape_normal(const struct shape *shape, struct vec3 position);
// The boundary's point nearest to `position`, which rounding has moved off the boundary.
struct vec3 shape_snap(const struct shape *shape, struct vec3 position);
