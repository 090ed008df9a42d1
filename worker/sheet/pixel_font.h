// Draws names and numbers into a picture: digits, letters as capitals, '.', '-', '_' and space, five pixels by seven.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

enum { PIXEL_FONT_WIDTH = 5, PIXEL_FONT_HEIGHT = 7 };

// Draws `text` white on a black box with its upper left corner at (x, y), `scale` times as large. Pixels outside the
// picture and characters that the font lacks are left out. `rgb` has 3 bytes a pixel.
void pixel_font_draw(unsigned char *rgb, int width_px, int height_px, int x, int y, int scale, const char *text);
int pixel_font_height(int scale);              // of the box, px
int pixel_font_count(int width_px, int scale); // how many characters fit into the width
