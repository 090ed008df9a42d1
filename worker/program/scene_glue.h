// Writes the part of a scene's shader that joins modules: lights, phases and main().
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdio.h>

struct scene_model;

void scene_glue_write_lights(FILE *out, const struct scene_model *model);
// `float march_reach(vec3 point, float step)`: how long a segment of midpoint or adaptive that begins at the point may be. Next to
// a point light, whose light rises and falls within a step, it is three tenths of the way there.
void scene_glue_write_step_limit(FILE *out, const struct scene_model *model);
// `has_frame_values`: main() begins by reading them.
void scene_glue_write_main(FILE *out, const struct scene_model *model, bool has_frame_values);
