// Reads the objects of a scene: their shapes and materials.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct scene;
struct scene_reader;

// `scene_reader` stands at an object whose key "objects" is read; absent: none. The scene's media have been read:
// interiors follow them. On failure the caller still calls scene_finish.
bool objects_from_json(struct scene *scene, const struct scene_reader *scene_reader);
