// A sheet of pictures, each beside the map of its differences from the truth.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct image;

struct error_strip_picture {
    const struct image *image; // borrowed; all have one size
    const char *label;         // borrowed
};

struct error_strip_params {
    const struct error_strip_picture *pictures;
    size_t count;
    struct error_strip_picture truth; // the picture that all are compared with; the last on the sheet
    const char *out;                  // the PNG to write
};

struct error_strip_result {
    int width_px, height_px;
    double scale; // the difference, relative to the truth's RMS, that has the brightest colour
};

// Writes the sheet. Maps are orange where a picture is too bright, blue where it is too dark, and black where it is
// right; a bar below shows the scale. A pixel's difference is the mean over its channels.
bool error_strip_write(const struct error_strip_params *params, struct error_strip_result *result, struct error *error);
