// GLSL of the grid of scattered light: the lookup in the picture's shader, and the program that fills the texture.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct error;
struct scatter_grid;
struct scatter_grid_program;
struct scene_cache;
struct scene_model;

// Writes the sampler and, for each medium that scatters, `Spectrum medium_I_scattered(vec3 point)`: the light there
// that was scattered before, weighed by the medium's phase function towards the camera.
void scatter_grid_glue_write_lookup(FILE *out, const struct scatter_grid *grid, const struct scene_model *model);

// Appends the caches that make the texture: what the picture sees of each node, the means of walks, and these prepared
// for interpolation. `caches` has room for them.
bool scatter_grid_glue_add_caches(struct scene_cache *caches, size_t *count, const struct scatter_grid_program *program,
                                  const char *shader_dir, struct error *error);
