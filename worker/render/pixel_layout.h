// Where the pixels of a list lie in the target: in squares, along a Morton curve.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/picture/pixel.h"

#include <stddef.h>
#include <stdint.h>

// Neighbours in the frame share SIMD units, and each processor of software GL has squares of its own. The zero value is
// empty.
struct pixel_layout {
    const struct pixel *pixels; // borrowed; outlive us
    size_t count;
    uint32_t *order;         // owned; indices of the list, along the curve
    int side;                // of a square, px: a power of two
    int square_count;        // the rest of the last square shows the last pixel again
    int width_px, height_px; // of the target
};

// Software GL hands its threads squares of the target of this side, px: each square of ours lies in one of them.
enum { PIXEL_LAYOUT_PITCH = 64 };

// `count` is at least 1 and below 2^32. `thread_count` is that of the processors which draw. The pixels are in frames
// of at most 65536 px a side.
void pixel_layout_init(struct pixel_layout *layout, const struct pixel *pixels, size_t count, int thread_count);
void pixel_layout_finish(struct pixel_layout *layout); // accepts an empty one

// The top left place of a square in the target.
struct pixel pixel_layout_square(const struct pixel_layout *layout, int square);
// The index in the list of the pixel which is drawn in a square, `x` and `y` from its top left place.
size_t pixel_layout_index(const struct pixel_layout *layout, int square, int x, int y);
// A strip is the part of the target that a row of squares takes: `side` rows of width_px. Between strips is nothing of
// the list, and far more than is in them where it is short.
int pixel_layout_strip_count(const struct pixel_layout *layout);
int pixel_layout_strip_y(int strip); // its first row in the target
// Copies a strip's values, `size` bytes a pixel, into the list's order.
void pixel_layout_gather(const struct pixel_layout *layout, int strip, const void *values, size_t size, void *list);
