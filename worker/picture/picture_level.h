// A picture as far as it is known: at the pixels whose place is a multiple of a stride.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct picture_level {
    float *rgba; // borrowed; 4 a point, premultiplied, top row first; the last points may lie beyond the picture
    int stride, columns, rows;
    int width_px, height_px; // of the picture
};

typedef void picture_level_callback(void *user, const struct picture_level *level);
