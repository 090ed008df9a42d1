// Writes what a picture does that is drawn in slices: each goes on where its rays had to stop.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct scene_model;

// Before and after integrator/sliced.glsl: what it asks for; and the pixel's state, which gl_slices.h keeps:
//   slice_load()        false for a pixel that is done
//   slice_store(paused) true when the pixel is done: its rays are, or came no further twice
void scene_glue_write_slice_random(FILE *out, const struct scene_model *model);
void scene_glue_write_slice(FILE *out, const struct scene_model *model);
