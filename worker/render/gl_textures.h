// The images of objects' textures, kept in GL from frame to frame, and bound where shaders look for them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct gl_functions;
struct gl_textures;
struct scene_inputs;

struct gl_textures *gl_textures_create(const struct gl_functions *gl); // which outlives the textures
void gl_textures_destroy(struct gl_textures *textures);                // accepts NULL
void gl_textures_clear(struct gl_textures *textures);                  // keeps nothing: what GL holds is in doubt

// Called after each image that was read. Returning false gives the rest up.
typedef bool gl_textures_progress(void *user);

// Reads what is not here yet, then binds object I's image to texture_unit_of_object(I). `inputs` are hashed;
// `on_progress` may be NULL. Images that need more memory than there is are an error.
bool gl_textures_bind(struct gl_textures *textures, const struct scene_inputs *inputs,
                      gl_textures_progress *on_progress, void *user, struct error *error);
