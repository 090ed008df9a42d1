// A volume's voxels as a GL texture, streamed there slab by slab: at no time are they held twice.
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
    unsigned voxels; // R8UI, R16UI, R16I or R32F; an array of slices, so that GL can gather the four around a point
    enum volume_type type; // as stored: 32-bit floats hold all of them, and what is 0 stays 0
    size_t size_bytes;     // of the voxels
    struct grid_bricks bricks;
};

// Called between slabs; false stops.
typedef bool gl_grid_progress(void *user);

struct gl_grid_params {
    const struct gl_functions *gl;
    struct volume *volume; // opened, nothing read; all of it is read
    const char *path;      // for messages
    gl_grid_progress *on_progress;
    void *user;
};

bool gl_grid_init(struct gl_grid *grid, const struct gl_grid_params *params, struct error *error);
void gl_grid_finish(struct gl_grid *grid); // accepts an empty one

// The texture of how far each brick is from one that is not empty, for density_grid_skip; the caller deletes it.
unsigned gl_grid_create_distances(const struct gl_grid *grid, double slope, double intercept,
                                  grid_bricks_is_empty *is_empty, const void *user);

// The greatest of what is made of values in [min, max].
typedef double gl_grid_find_most(double min, double max, const void *user);
// The texture of that number of each brick, for density_grid_majorant; the caller deletes it.
unsigned gl_grid_create_majorants(const struct gl_grid *grid, double slope, double intercept,
                                  gl_grid_find_most *find_most, const void *user);
