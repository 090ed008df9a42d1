// The grids that scenes show, kept in GL from frame to frame, and bound where shaders look for them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/render/gl_grid.h"

#include <stdbool.h>

struct error;
struct gl_functions;
struct gl_grids;
struct scene_inputs;

struct gl_grids *gl_grids_create(const struct gl_functions *gl); // which outlives the grids
void gl_grids_destroy(struct gl_grids *grids);                   // accepts NULL
void gl_grids_clear(struct gl_grids *grids);                     // keeps nothing: what GL holds is in doubt

// Reads what is not here yet, then binds each medium's textures to its units (texture_units.h). `inputs` are hashed.
bool gl_grids_bind(struct gl_grids *grids, const struct scene_inputs *inputs, gl_grid_progress *on_progress, void *user,
                   struct error *error);
