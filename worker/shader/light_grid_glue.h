// GLSL of a light's grid: the lookup in the picture's shader, and the programs that fill the texture.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct error;
struct light_grid;
struct scene_cache;
struct scene_model;

enum { LIGHT_GRID_CACHES = 2 }; // the columns, then these prepared for interpolation

const char *light_grid_glue_module(const struct light_grid *grid); // says where the nodes lie
// Writes the sampler light_I_columns and `MediaColumn light_I_column(vec3 point, LightSample light)`: the columns of
// all media towards the light, those of homogeneous media in closed form.
void light_grid_glue_write_lookup(FILE *out, const struct light_grid *grid);
// Appends the caches that make the texture. `model` is the picture's; `caches` has room for LIGHT_GRID_CACHES more.
bool light_grid_glue_add_caches(struct scene_cache *caches, size_t *count, const struct light_grid *grid,
                                const struct scene_model *model, const char *shader_dir, struct error *error);
