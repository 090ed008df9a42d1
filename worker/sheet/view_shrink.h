// Shrinks a part of a picture while its lines arrive: each pixel is the mean of what it covers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;

struct view_part {
    int x, y, width_px, height_px;
};

enum view_shrink_kind {
    VIEW_SHRINK_ONE,   // one channel
    VIEW_SHRINK_THREE, // three
    VIEW_SHRINK_DEPTH  // one, whose mean is over the values above 0
};

// The zero value is empty.
struct view_shrink {
    struct view_part part;
    enum view_shrink_kind kind;
    int width_px, height_px; // of the result
    float *sums;             // owned; `planes` a pixel
    size_t planes;
};

// The result's longest side is at most `size_px`; nothing is enlarged.
bool view_shrink_init(struct view_shrink *shrink, const struct view_part *part, int size_px, enum view_shrink_kind kind,
                      struct error *error);
void view_shrink_finish(struct view_shrink *shrink);
// Takes a line of the whole picture: `width` values of a channel, then those of the next. Lines outside of the part are
// left out, and values that are not finite count as 0.
void view_shrink_add_line(struct view_shrink *shrink, int row, const float *values, size_t width);
// The value of a pixel once all lines were added; `channel` is 0 to 2.
float view_shrink_value(const struct view_shrink *shrink, size_t pixel, size_t channel);
