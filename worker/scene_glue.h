// Writes the part of a scene's shader that joins modules: lights, phases and main().
#pragma once

#include <stdio.h>

struct job;
struct scene_program;

void scene_glue_write_lights(FILE *out, const struct job *job, const struct scene_program *program);
void scene_glue_write_main(FILE *out, const struct job *job, const struct scene_program *program);
