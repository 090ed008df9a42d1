// Sparse grids as textures hold them: bricks with what interpolation reaches beyond them, and where each brick is.
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
    float *values[BRICK_ATLAS_GRIDS]; // owned; of the density, and of what glows where there is density or NULL
    int brick_min[3];                 // of the lattice, as in struct sparse_grid
    int brick_count[3];
    uint16_t (*index)[4]; // owned; of each brick, i fastest: its slot, and how many bricks away the nearest density is
    int voxel_min[3], voxel_max[3]; // the box of the density's active voxels, inclusive
    struct grid_bound bound;        // of all values that interpolation between the density's voxels reaches
    double index_to_world[12];
    size_t size_bytes; // of values and index
};

struct brick_atlas_params {
    const struct sparse_grid *density;
    const struct sparse_grid *glow; // NULL: none; its voxels must lie where those of `density` do
    grid_bricks_is_empty *is_empty; // of a range of the density grid's values; NULL: where none is above 0
    const void *user;               // passed to it
    int64_t memory_bytes;           // that values and their textures may take; 0: what this process may hope for
};

// NULL on failure; the caller destroys the atlas.
struct brick_atlas *brick_atlas_create(const struct brick_atlas_params *params, struct error *error);
void brick_atlas_destroy(struct brick_atlas *atlas); // NULL is accepted
