// Writes the part of a scene's shader that joins modules: lights, phases and main().
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdio.h>

struct scene_model;

void scene_glue_write_lights(FILE *out, const struct scene_model *model);
// `float march_step_limit(vec3 point, float step)`: the longest segment that may begin at the point. Next to a point
// light, whose irradiance rises and falls within a step, it is a share of the distance to the light.
void scene_glue_write_step_limit(FILE *out, const struct scene_model *model);
// `has_frame_values`: main() begins by reading the frame's uniforms.
void scene_glue_write_main(FILE *out, const struct scene_model *model, bool has_frame_values);
