// The GLSL that finds the colour of an object's texture, between shaders/texture/ and the object's shapes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdio.h>

struct job;
struct scene_model;

// The modules that it calls, ending in NULL, in the order of their use; those of regions and of surfaces' normals come before them.
const char *const *texture_glue_modules(const struct job *job, size_t object);
// Writes, for an object with a texture,
//     vec3 object_I_texture(vec3 p, int shape)
// : the image's linear light at p on the scene's shape of that index, or, when that is none of the object's, as if p were on
// its first. It calls `shape_K()`, which gives shape K's RegionSphere, RegionBox or RegionPlane.
void texture_glue_write(FILE *out, const struct scene_model *model, size_t object);
