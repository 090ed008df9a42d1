// Contact sheets and film frames from an EXR sequence, one exposure for all of it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;

struct preview_params {
    const char *const *files; // absolute EXR paths
    size_t file_count;
    const char *const *labels; // one per file, or NULL
    int columns;               // 0: chosen so that the sheet is about 3:2
    int tile_width_px;         // 0: 320
    bool has_exposure;
    double exposure; // stops
    const char *out; // the PNG to write (sheet), or the folder (frames)
};

struct preview_result {
    double exposure;
    int width_px, height_px;
    int64_t fps_numerator, fps_denominator; // of the first file, for frames alone; 0: it does not say
};

// Writes a contact sheet in sRGB, over black. An exposure that is chosen brings the 99th percentile of the sequence's
// luminance to 0.8.
bool preview_write_sheet(const struct preview_params *params, struct preview_result *result, struct error *error);
// Writes 000000.png, 000001.png, ... of the full size into the folder `out`.
enum { PREVIEW_NAME_SIZE = 32 };
void preview_format_name(size_t index, char name[static PREVIEW_NAME_SIZE]);
bool preview_write_frames(const struct preview_params *params, struct preview_result *result, struct error *error);
