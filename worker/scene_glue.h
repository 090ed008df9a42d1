// Writes the part of a scene's shader that joins modules: lights, phases and what a sample adds to a pixel.
#pragma once

#include <stdio.h>

struct job;
struct scene_program;

void scene_glue_write_lights(FILE *out, const struct job *job, const struct scene_program *program);
// `Gathered` and `gather`, called by the integrator for each place that has density.
void scene_glue_write_gather(FILE *out, const struct job *job, const struct scene_program *program);
void scene_glue_write_main(FILE *out, const struct job *job, const struct scene_program *program);
