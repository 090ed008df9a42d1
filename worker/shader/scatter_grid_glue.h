// GLSL of the grid of scattered light: the lookup in the picture's shader, and the program that fills the texture.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct error;
struct light_grid;
struct scatter_grid;
struct scene_cache;
struct scene_model;

// Writes the sampler and, for each medium that scatters, `Spectrum medium_I_scattered(vec3 point)`: the light there
// that was scattered before, weighed by the medium's phase function towards the camera.
void scatter_grid_glue_write_lookup(FILE *out, const struct scatter_grid *grid, const struct scene_model *model);

struct scatter_grid_program {
    const struct scatter_grid *grid;
    const struct scene_model *walked;     // of the walks: its features have fills_grid
    const struct light_grid *light_grids; // of the visible lights, in order, where the walks' model has light grids
    size_t light_grid_count;
    uint64_t reads; // bit i: it samples cache i of the program
};

// Appends the caches that make the texture: the means of walks, then these prepared for interpolation. `caches` has
// room for both.
bool scatter_grid_glue_add_caches(struct scene_cache *caches, size_t *count, const struct scatter_grid_program *program,
                                  const char *shader_dir, struct error *error);
