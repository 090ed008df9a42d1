// Boxes along the world's axes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/vec3.h"

#include <math.h>
#include <stdbool.h>

struct box {
    struct vec3 center;
    struct vec3 half; // of its sides, m; INFINITY: the box is all of space
};

static inline bool box_holds(const struct box *box, struct vec3 position)
{
    struct vec3 off = vec3_subtract(position, box->center);

    return fabs(off.x) <= box->half.x && fabs(off.y) <= box->half.y && fabs(off.z) <= box->half.z;
}

// The distance from the centre to a corner.
static inline double box_radius(const struct box *box)
{
    return vec3_length(box->half);
}
