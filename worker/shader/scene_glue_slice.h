// Writes what a picture drawn in slices needs: each slice goes on where the rays of the one before it stopped.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct scene_model;

// Before and after integrator/sliced.glsl: what it calls, and the pixel's state, which gl_slices.h keeps:
//   slice_load()        false for a pixel that is done
//   slice_store(paused) true when the pixel is done: its rays are, or two slices brought them no further
void scene_glue_write_slice_random(FILE *out, const struct scene_model *model);
void scene_glue_write_slice(FILE *out, const struct scene_model *model);
