// A light's grid: columns of the media from the light to each node, one channel a medium.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/glsl/frame_uniforms.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct scene_inputs;
struct scene_model;

enum light_grid_kind {
    LIGHT_GRID_BEAM, // shaders/light_grid/beam.glsl
    LIGHT_GRID_ROUND // shaders/light_grid/round.glsl
};

struct light_grid {
    const struct job *job;             // borrowed; outlives us
    const struct scene_inputs *inputs; // borrowed; outlives us. NULL where the job reads no files
    size_t light;
    enum light_grid_kind kind;
    int cells;                             // along each side; there is one more node than cells
    size_t media[JOB_CACHED_MEDIUM_LIMIT]; // by channel; those whose columns are marched
    size_t medium_count;
    uint64_t densities; // bit i: cache i of the program, an earlier one, holds the density of one of these media
    bool is_still;      // nothing that its position follows from moves
};

// The grid's position at a moment, with the names of its shader modules.
struct light_grid_placement {
    double center[3], from_unit[9], to_unit[9], origin[3], taper; // of a beam; matrices are column-major
    double near, far;                                             // of a round one
};

// Initializes the grid of a visible light, of the kind that serves all moments of the inputs' frame.
void light_grid_init(struct light_grid *grid, const struct scene_model *model, size_t light);
void light_grid_place(const struct light_grid *grid, double time, struct light_grid_placement *placement);
// Adds light_I_grid_center, _from_unit, _to_unit, _origin, _taper of a beam; light_I_grid_near, _far of a round grid,
// which also needs light_I_position. `index` is the I. The grid outlives the values.
void light_grid_add_values(struct frame_uniforms *uniforms, const struct light_grid *grid, size_t index);
