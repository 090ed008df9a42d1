// The images of objects' textures and of a dome, kept in GL from frame to frame and bound to their units.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct gl_functions;
struct gl_textures;
struct scene_inputs;

struct gl_textures *gl_textures_create(const struct gl_functions *gl); // `gl` outlives the textures
void gl_textures_destroy(struct gl_textures *textures);                // accepts NULL
void gl_textures_clear(struct gl_textures *textures);                  // drops all, for the contents are in doubt

// Called after each image that was read. Returning false stops the rest.
typedef bool gl_textures_progress(void *user);

// Reads the images that are not kept, then binds object I's image to texture_unit_of_object(I), a dome's to
// TEXTURE_UNIT_DOME and its table to TEXTURE_UNIT_DOME_TABLE. `inputs` are hashed; `on_progress` may be NULL. Images
// that need more memory than the process has are an error.
bool gl_textures_bind(struct gl_textures *textures, const struct scene_inputs *inputs,
                      gl_textures_progress *on_progress, void *user, struct error *error);
