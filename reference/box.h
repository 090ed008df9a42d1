// Boxes along the world's axes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/vec3.h"

struct box {
    struct vec3 center;
    struct vec3 half; // of its sides, m; INFINITY: the box is all of space
};

// The distance from the centre to a corner.
static inline double box_radius(const struct box *box)
{
    return vec3_length(box->half);
}
