// Holds a sparse grid's bricks as GL textures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/sparse/brick_atlas.h"

#include <stdbool.h>

struct error;
struct gl_functions;

// The zero value is empty.
struct gl_bricks {
    const struct gl_functions *gl; // borrowed; outlives us
    unsigned index;                // RGBA16UI, one texel a brick
    // R32F, arrays of layers, so that GL can gather the four texels around a point; 0: none.
    unsigned values[BRICK_ATLAS_GRIDS];
};

bool gl_bricks_init(struct gl_bricks *bricks, const struct gl_functions *gl, const struct brick_atlas *atlas,
                    struct error *error);
void gl_bricks_finish(struct gl_bricks *bricks); // accepts an empty one
