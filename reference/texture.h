// Images on surfaces: the texture coordinates of a point, and the colour there.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/shape.h"

#include <stdbool.h>

struct texture {
    const float *rgb; // borrowed; outlives us; linear, 3 a texel, rows from the top; NULL: there is none
    int width, height;
    bool is_nearest; // else bilinear
    double size[2];  // m of a tile, across and up; an `up` of 0: as the image's sides are; not used on spheres
};

// u to the right and v up, 0 and 1 being the image's borders; both may be outside [0, 1]. See struct scene_texture.
struct texture_coordinates {
    double u, v;
};

struct texture_coordinates texture_find(const struct texture *texture, const struct shape *shape, struct vec3 position);
// Repeats in both directions; texel (i, j) has its centre at ((i + 1/2) / width, 1 - (j + 1/2) / height).
void texture_sample(const struct texture *texture, struct texture_coordinates at, double color[static 3]);
