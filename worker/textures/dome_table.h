// The table by which shaders draw directions to a dome's image: many where it is bright.
// SPDX-License-Identifier: Apache-2.0
// Rows and columns are drawn by Walker's aliases (ACM Transactions on Mathematical Software 3, 1977), in tables made as
// Vose does (IEEE Transactions on Software Engineering 17, 1991). A texel's light is the mean of the three colours over
// it, of an image that is bilinear between the middles of texels, times its solid angle.
#pragma once

#include "worker/picture/image.h"

struct error;

// Makes the table of `image`, which is one row higher, and as wide as the image or, if that is more, as high. Of texel
// (x, y) of the image the red is the share of its own draws, green the column that has the rest, blue the density of
// directions per steradian. Red and green of the last row are the same for the image's rows. A black image's directions
// are even. The caller finishes the table. False when there is no memory.
bool dome_table_init(struct image *table, const struct image *image, struct error *error);
// The table's sides.
void dome_table_size(int width_px, int height_px, int *table_width_px, int *table_height_px);
