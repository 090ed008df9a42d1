// Writes the part of a scene's shader that joins modules: lights, phases and main().
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct job;
struct scene_program;

void scene_glue_write_lights(FILE *out, const struct job *job, const struct scene_program *program);
// `float march_reach(vec3 point, float step)`: how long a segment of midpoint or adaptive that begins at the point may be. Next to
// a point light, whose light rises and falls within a step, it is three tenths of the way there.
void scene_glue_write_reach(FILE *out, const struct job *job, const struct scene_program *program);
void scene_glue_write_main(FILE *out, const struct job *job, const struct scene_program *program);
