// GLSL for the colour of an object's texture, between shaders/texture/ and the object's shapes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdio.h>

struct job;
struct scene_model;

// Returns the modules that the function calls, in order, ending in NULL. Those of regions and of surfaces' normals come
// before.
const char *const *texture_glue_modules(const struct job *job, size_t object);
// Writes `vec3 object_I_texture(vec3 p, int shape)` for an object with a texture: the image's linear light at p on the
// scene's shape of that index. For a shape that is not the object's, the object's first shape is taken. The function
// calls `shape_K()`, which returns shape K's RegionSphere, RegionBox or RegionPlane.
void texture_glue_write(FILE *out, const struct scene_model *model, size_t object);
