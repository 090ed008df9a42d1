// The programs that fill the grid of a density that is baked.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct density_site;
struct error;
struct scene_cache;

enum { DENSITY_FILL_CACHES = 2 }; // the field's samples, then these prepared for interpolation

// Appends the caches that make the grid of a medium that is baked. `caches` has room for DENSITY_FILL_CACHES more.
bool density_fill_add_caches(struct scene_cache *caches, size_t *count, const struct density_site *site,
                             const char *shader_dir, struct error *error);
