// A texture's image in GL.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct gl_functions;
struct image;

// Room for red, green and blue as 32-bit floats, for shaders/texture/: unfiltered. The caller deletes it. An image that GL has
// no room for, or whose sides are too long for it, is an error.
bool gl_texture_create(const struct gl_functions *gl, int width_px, int height_px, unsigned *texture,
                       struct error *error);
// `image`, of the sides that the texture was created with; its first row is the texels' first.
void gl_texture_fill(const struct gl_functions *gl, unsigned texture, const struct image *image);
