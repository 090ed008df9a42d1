// GLSL of the program that finds what the picture sees of each node of the grid of scattered light.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

// The first of its sums has the bits of the largest such share; the others are for the numbers of walks and of their
// steps.
enum { SCATTER_SEEN_SUMS = 3 };

struct error;
struct scatter_grid_program;
struct scene_cache;

// Makes the cache `scatter_seen`, a number for each node of one set: below 0 where nothing looks it up, else the share
// of a pixel that light scattered there covers.
bool scatter_seen_glue_make(struct scene_cache *cache, const struct scatter_grid_program *program,
                            const char *shader_dir, struct error *error);
