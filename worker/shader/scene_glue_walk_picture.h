// Writes the part of a scene's shader that adds a pixel's random paths up, slice by slice.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct scene_model;

// Before main(), what it keeps of a pixel from slice to slice, in five images of gl_slices.h:
//   walk_load(walk)           false for a pixel that is done; else where its paths go on
//   walk_store(walk, is_done)
void scene_glue_write_walk_slice(FILE *out, const struct scene_model *model);
// Writes the part of main() behind the camera ray: sums over paths become light, transmittance and depth.
void scene_glue_write_walk_picture(FILE *out, const struct scene_model *model);
