// Reads PNG files as images of linear light.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct image;

struct image_png_facts {
    int width_px, height_px;
    int bits; // of a value: 1 to 8, or 16
};

// Reads any PNG file, up to IMAGE_SIDE_LIMIT a side: grey becomes three equal values, palettes are resolved, alpha is
// ignored and 1 in the image. A value v of n bits is v / (2^n - 1), decoded from sRGB unless `is_linear`, and rounded
// once. Gamma, primaries, profiles and texts in the file are ignored. A file that is damaged or ends too soon is an
// error. `image` may be NULL to read the header only; on failure it is empty. `facts` may be NULL. The descriptor's
// offset is not used.
bool image_png_read(int fd, bool is_linear, struct image *image, struct image_png_facts *facts, struct error *error);
