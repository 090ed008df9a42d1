// Images of textures and domes, from PNG and EXR files: linear light.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct image;
struct scene_texture;

// The first bytes say which kind of file it is. Messages begin with `path`.
bool texture_image_find_size(const char *path, int *width_px, int *height_px, struct error *error);
// Loads red, green and blue of the texture's file, taken as Rec. 709 whatever the file says; alpha is undefined. Values
// are decoded from sRGB unless they are linear. A value outside of [0, 1], or of [0, SCENE_IMAGE_RADIANCE_LIMIT] where
// it is radiance, is an error that names the pixel. An image that needs more memory than there is, here and for a copy
// in GL, is an error.
bool texture_image_load(struct image *image, const struct scene_texture *texture, struct error *error);
