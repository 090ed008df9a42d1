// Reads the image on a surface.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct scene_reader;
struct scene_texture;

// `material` stands at an object whose key "texture" is read; absent: none. `has_size` says whether it covers any shape that
// takes a tile's size, which all but spheres do. On failure the caller still calls scene_finish.
bool texture_from_json(struct scene_texture *texture, const struct scene_reader *material, bool has_size);
