// PNG files of every kind, made byte by byte by the standard (ISO/IEC 15948:2004), without the tested library.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum png_color { PNG_GREY = 0, PNG_RGB = 2, PNG_PALETTE = 3, PNG_GREY_ALPHA = 4, PNG_RGB_ALPHA = 6 };

struct png_params {
    int width, height;
    enum png_color color;
    int bits;
    bool is_interlaced;
    const uint16_t *values; // each less than 2^bits, png_maker_channels() a pixel, first row on top
    const unsigned char (*palette)[3];
    int palette_count;
    int text_count; // compressed texts ahead of the pixels
    size_t text_size;
};

int png_maker_channels(enum png_color color);
// Owned by the caller.
unsigned char *png_maker_make(const struct png_params *params, size_t *size_bytes);
// 8-bit RGB from `rgb`, 3 bytes a pixel.
void png_maker_write_rgb(const char *path, int width, int height, const unsigned char *rgb);
