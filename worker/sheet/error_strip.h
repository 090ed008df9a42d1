// Pictures beside maps of what is wrong with each, on one sheet.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct image;

struct error_strip_picture {
    const struct image *image; // borrowed; all of one size
    const char *label;         // borrowed
};

struct error_strip_params {
    const struct error_strip_picture *pictures;
    size_t count;
    struct error_strip_picture truth; // what they are compared with; the last picture of the sheet
    const char *out;                  // the PNG to write
};

struct error_strip_result {
    int width_px, height_px;
    double scale; // the difference, relative to the truth's RMS, that has the brightest colour
};

// A map's colours: what is too bright is orange, what is too dark blue, black what is right; a bar below tells how much. A pixel's
// difference is the mean of its channels'.
bool error_strip_write(const struct error_strip_params *params, struct error_strip_result *result, struct error *error);
