// What a light's grid adds to shaders: the look-up in the picture's, and the programs that fill its texture.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct error;
struct light_grid;
struct scene_cache;
struct scene_model;

enum { LIGHT_GRID_CACHES = 2 }; // the columns and what is kept of them

const char *light_grid_glue_module(const struct light_grid *grid); // where its nodes lie
// The sampler light_I_columns and `MediaColumn light_I_column(vec3 point, LightSample light)`: of all media towards the
// light, those of even density in closed form.
void light_grid_glue_write_lookup(FILE *out, const struct light_grid *grid);
// Appends the caches that make the texture. `model` is the picture's; `caches` has room for LIGHT_GRID_CACHES more.
bool light_grid_glue_add_caches(struct scene_cache *caches, size_t *count, const struct light_grid *grid,
                                const struct scene_model *model, const char *shader_dir, struct error *error);
