// A texture's image in GL.
#pragma once

#include <stdbool.h>

struct error;
struct gl_functions;
struct image;

// Red, green and blue as 32-bit floats, for shaders/texture/: unfiltered, the image's first row being the texels' first. The
// caller deletes it. An image that GL has no room for, or whose sides are too long for it, is an error.
bool gl_texture_create(const struct gl_functions *gl, const struct image *image, unsigned *texture,
                       struct error *error);
