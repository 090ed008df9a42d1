// The grids of scenes, kept in GL from frame to frame and bound to the units where shaders sample them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/textures/gl_grid.h"

#include <stdbool.h>

struct error;
struct gl_functions;
struct gl_grids;
struct scene_input;
struct scene_inputs;

struct gl_grids *gl_grids_create(const struct gl_functions *gl); // `gl` outlives the grids
void gl_grids_destroy(struct gl_grids *grids);                   // accepts NULL
void gl_grids_clear(struct gl_grids *grids);                     // drops all, for the contents are in doubt

// Reads the grids that are not kept, then binds each medium's textures to its units (texture_units.h). `inputs` are
// hashed.
bool gl_grids_bind(struct gl_grids *grids, const struct scene_inputs *inputs, gl_grid_progress *on_progress, void *user,
                   struct error *error);
// Returns the bricks of an input's grid; NULL where it is sparse or not kept.
const struct grid_bricks *gl_grids_find_bricks(struct gl_grids *grids, const struct scene_input *input);
