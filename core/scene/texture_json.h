// Reads the texture of a material.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct scene_reader;
struct scene_texture;

// `material` stands at an object whose key "texture" is read; absent: none. `has_size` is true when the object has a
// shape other than spheres, on which a tile has a size. On failure the caller still calls scene_finish.
bool texture_from_json(struct scene_texture *texture, const struct scene_reader *material, bool has_size);
