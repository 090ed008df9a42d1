// One channel of one picture as a PNG: all of it or a part, as large as it is or smaller.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

enum { VIEW_SIZE_LIMIT = 4096 }; // px; the longest side of a PNG

struct view_params {
    int fd; // borrowed; of the EXR file
    // "color", a channel's name, or the name before .R, .G and .B of three. NULL: "color"
    const char *channel;
    bool has_exposure;
    double exposure;         // stops
    int x, y;                // px; the part's upper left corner
    int width_px, height_px; // of the part; 0: up to the picture's edge
    int size_px;             // the PNG's longest side, at most; 0: VIEW_SIZE_LIMIT
    const char *out;         // the PNG to write
};

struct view_result {
    int width_px, height_px; // of the PNG
    int file_width_px, file_height_px;
    double exposure;  // NaN: the channel has none
    double near, far; // m; the least and the greatest depth of the picture; NaN: the channel is no depth, or has none
};

enum view_fault {
    VIEW_FAULT_FILE,   // it cannot be read
    VIEW_FAULT_PARAMS, // it has no such channel, or no such part
    VIEW_FAULT_OUTPUT  // the PNG cannot be written
};

// Pixels are averaged as linear light, never enlarged; values that are not finite count as 0.
// A colour is shown in sRGB over black. Its exposure, if none is given, is the one that brings the 99th percentile of
// the whole picture's luminance to 0.8. Alpha and transmittance are shown as they are unless an exposure is given.
// Depth has no exposure: the nearest point of the picture is white, the farthest dark grey, by the reciprocal of the
// depth between them, and black has no depth.
bool view_write(const struct view_params *params, struct view_result *result, enum view_fault *fault,
                struct error *error);
