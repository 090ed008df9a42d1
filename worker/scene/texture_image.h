// The image of a texture, from a PNG or EXR file: linear light in [0, 1].
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct image;

// The kind is told by the first bytes. Messages begin with `path`.
bool texture_image_find_size(const char *path, int *width_px, int *height_px, struct error *error);
// Red, green and blue, taken for those of Rec. 709 whatever the file says; alpha is passed over and undefined. Values are
// decoded from sRGB unless `is_linear`. One that is not in [0, 1] is an error that names the pixel, and so is an image that
// needs more memory than there is, here and for a copy in GL.
bool texture_image_load(struct image *image, const char *path, bool is_linear, struct error *error);
