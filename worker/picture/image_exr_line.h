// A line of an image as EXR files store it: the first value of all pixels, then the second.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct image;

// Channels follow one another sorted by name: A, B, G, R, Z (always floats), transmittance.B, .G, .R. With `is_half`
// the other values are halves, else floats.
size_t image_exr_line_bytes(const struct image *image, bool is_half);
// Writes so many bytes of row `y` to `line`, whose address is even.
void image_exr_line_pack(const struct image *image, bool is_half, int y, void *line);
