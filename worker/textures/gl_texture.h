// One image as a GL texture.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct gl_functions;
struct image;

// Creates an empty RGBA texture of 32-bit floats, unfiltered, for shaders/texture/. The caller deletes it. Sides that
// are too long for GL, and too little memory, are errors.
bool gl_texture_create(const struct gl_functions *gl, int width_px, int height_px, unsigned *texture,
                       struct error *error);
// Copies `image`, which has the sides that the texture was created with; its first row is the texels' first.
void gl_texture_fill(const struct gl_functions *gl, unsigned texture, const struct image *image);
