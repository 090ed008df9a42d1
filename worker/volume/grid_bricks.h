// The smallest and largest value of each brick of a volume, found while its slices stream by, and how far emptiness reaches.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/volume/volume_voxels.h"

#include <stdbool.h>

struct error;

enum {
    GRID_BRICK_CELLS = 8, // a side; the brick at b spans the index coordinates [8 b, 8 b + 8]
    GRID_BRICK_FAR = 255  // bricks; distances end here
};

struct grid_bound {
    float min, max; // stored numbers, not yet by slope and intercept
};

// The zero value is empty.
struct grid_bricks {
    int size[3];               // voxels
    int count[3];              // bricks along i, j, k
    struct grid_bound *bounds; // owned; i fastest. Of all that interpolation inside the brick reaches.
};

bool grid_bricks_init(struct grid_bricks *bricks, const int size[3], struct error *error);
void grid_bricks_finish(struct grid_bricks *bricks); // accepts an empty one
// Takes in `slice_count` slices, the first being `first_slice`; each slice is to come once.
void grid_bricks_add(struct grid_bricks *bricks, enum volume_type type, const void *slices, int first_slice,
                     int slice_count);

// True when nothing is where values are within [min, max].
typedef bool grid_bricks_is_empty(double min, double max, const void *user);
// For each brick how many bricks away, in the largest of the three directions, the nearest one is that is not empty: 0 for
// one that itself is not, at most GRID_BRICK_FAR. `distances` has room for all bricks. Values are slope * stored + intercept.
void grid_bricks_find_distances(const struct grid_bricks *bricks, double slope, double intercept,
                                grid_bricks_is_empty *is_empty, const void *user, unsigned char *distances);
