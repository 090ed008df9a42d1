// Sparse grids in the form of textures: bricks with the voxels beside them that interpolation uses, and an index.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/volume/grid_bricks.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct sparse_grid;

enum {
    BRICK_ATLAS_SIDE = 9, // a brick's 8 voxels and the next brick's first
    BRICK_ATLAS_GRIDS = 2
};

// Texel (x, y, z) of a grid's values is at x + width (y + height z). Bricks without density share the slot (0, 0, 0).
struct brick_atlas {
    int slots[3];                     // along x, y, z
    int texels[3];                    // BRICK_ATLAS_SIDE times as many
    float *values[BRICK_ATLAS_GRIDS]; // owned; of the density, and of what glows (NULL: none)
    int brick_min[3];                 // of the lattice, as in struct sparse_grid
    int brick_count[3];
    // Owned; for each brick, i fastest: its slot, and its distance in bricks to the nearest density.
    uint16_t (*index)[4];
    int voxel_min[3], voxel_max[3]; // the box of the density's active voxels, inclusive
    struct grid_bound bound;        // of all values that interpolation of the density can give
    double index_to_world[12];
    size_t size_bytes; // of values and index
};

struct brick_atlas_params {
    const struct sparse_grid *density;
    const struct sparse_grid *glow; // NULL: none; it has the positions of `density`'s voxels
    grid_bricks_is_empty *is_empty; // for a range of the density's values; NULL: empty where none is above 0
    const void *user;               // passed to it
    int64_t memory_bytes;           // the most that values and their textures may take; 0: volume_memory_limit
};

// Returns NULL on failure. The caller destroys the atlas.
struct brick_atlas *brick_atlas_create(const struct brick_atlas_params *params, struct error *error);
void brick_atlas_destroy(struct brick_atlas *atlas); // NULL is accepted
