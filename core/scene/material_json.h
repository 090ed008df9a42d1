// Reads the material of an object, and the medium that fills it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct scene;
struct scene_reader;

// `object` stands at scene.objects[index], whose key "material" is read and whose shapes have been read. An interior is
// appended to the scene's media. On failure the caller still calls scene_finish.
bool material_from_json(struct scene *scene, size_t index, const struct scene_reader *object);
