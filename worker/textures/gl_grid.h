// Holds a volume's voxels as a GL texture, streamed there slab by slab, so that they are never in memory twice.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/volume/grid_bricks.h"
#include "worker/volume/volume.h"

#include <stdbool.h>
#include <stddef.h>

struct error;
struct gl_functions;

// The zero value is empty.
struct gl_grid {
    const struct gl_functions *gl; // borrowed; outlives us
    // R8UI, R16UI, R16I or R32F; an array of slices, so that GL can gather the four voxels around a point.
    unsigned voxels;
    enum volume_type type; // as stored; 32-bit floats hold each exactly
    size_t size_bytes;     // of the voxels
    struct grid_bricks bricks;
};

// Called between slabs; false stops the reading.
typedef bool gl_grid_progress(void *user);

struct gl_grid_params {
    const struct gl_functions *gl;
    struct volume *volume; // open, at its first slice; all of it is read
    const char *path;      // for messages
    gl_grid_progress *on_progress;
    void *user;
};

bool gl_grid_init(struct gl_grid *grid, const struct gl_grid_params *params, struct error *error);
void gl_grid_finish(struct gl_grid *grid); // accepts an empty one

// Creates the texture of each brick's distance to the nearest brick that is not empty, for density_grid_skip; 0: no
// memory. The caller deletes it.
unsigned gl_grid_create_distances(const struct gl_grid *grid, double slope, double intercept,
                                  grid_bricks_is_empty *is_empty, const void *user);

// Returns the greatest density or opacity of values in [min, max].
typedef double gl_grid_find_most(double min, double max, const void *user);
// Creates the texture of each brick's majorant, for density_grid_majorant; where that is 0, minus the distance to the
// nearest brick that has one, as in gl_grid_create_distances. 0: no memory. The caller deletes it.
unsigned gl_grid_create_majorants(const struct gl_grid *grid, double slope, double intercept,
                                  gl_grid_find_most *find_most, const void *user);
