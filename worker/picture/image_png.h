// Writes PNG files for display: 8-bit sRGB.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

// `rgb` has 3 bytes a pixel, top row first. The file appears whole or not at all.
bool image_png_write(const char *path, const unsigned char *rgb, int width_px, int height_px, struct error *error);
