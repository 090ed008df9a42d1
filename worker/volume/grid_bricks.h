// The bounds of the values in each brick of a volume, and each brick's distance to the nearest that is not empty.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/volume/volume_voxels.h"

#include <stdbool.h>

struct error;

enum {
    GRID_BRICK_CELLS = 8, // per side; the brick at b spans the index coordinates [8 b, 8 b + 8]
    GRID_BRICK_FAR = 255  // bricks; larger distances are stored as this
};

struct grid_bound {
    float min, max; // stored numbers, before slope and intercept
};

// The zero value is empty.
struct grid_bricks {
    int size[3];               // voxels
    int count[3];              // bricks along i, j, k
    struct grid_bound *bounds; // owned; i fastest; of all voxels that interpolation inside the brick uses
};

bool grid_bricks_init(struct grid_bricks *bricks, const int size[3], struct error *error);
void grid_bricks_finish(struct grid_bricks *bricks); // accepts an empty one
// Adds `slice_count` slices from `first_slice` on. Each slice is added once.
void grid_bricks_add(struct grid_bricks *bricks, enum volume_type type, const void *slices, int first_slice,
                     int slice_count);

// Returns true when values within [min, max] have no density.
typedef bool grid_bricks_is_empty(double min, double max, const void *user);
// Finds each brick's chessboard distance, in bricks, to the nearest brick that is not empty: 0 for one that is not
// empty itself, at most GRID_BRICK_FAR. `distances` has room for all bricks. Values are slope * stored + intercept.
void grid_bricks_find_distances(const struct grid_bricks *bricks, double slope, double intercept,
                                grid_bricks_is_empty *is_empty, const void *user, unsigned char *distances);
