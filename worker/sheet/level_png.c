// SPDX-License-Identifier: Apache-2.0
#include "worker/sheet/level_png.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "worker/picture/image.h"
#include "worker/picture/image_png_quick.h"
#include "worker/picture/picture_level.h"
#include "worker/picture/srgb_table.h"
#include "worker/sheet/exposure.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

static float find_gain(const struct picture_level *level)
{
    const struct image points = {.width_px = level->columns, .height_px = level->rows, .rgba = level->rgba};
    struct exposure *exposure = xcalloc(1, sizeof *exposure);
    double stops;

    exposure_add_image(exposure, &points);
    stops = exposure_choose(exposure);
    free(exposure);
    return (float)exp2(stops);
}

static int find_nearest(const struct picture_level *level, int at)
{
    return (at + level->stride / 2) / level->stride;
}

static void draw_row(const struct picture_level *level, int row, float gain, const struct srgb_table *bytes,
                     unsigned char *rgb)
{
    const float *points = level->rgba + 4 * (size_t)row * (size_t)level->columns;

    for (int x = 0, last = -1; x < level->width_px; x++, rgb += 3) {
        int column = find_nearest(level, x);

        for (int c = 0; c < 3; c++)
            rgb[c] = column == last ? rgb[c - 3] : srgb_table_encode(bytes, points[4 * column + c] * gain);
        last = column;
    }
}

bool level_png_write(const char *path, const struct picture_level *level, struct error *error)
{
    size_t row_bytes = 3 * (size_t)level->width_px;
    unsigned char *rgb = malloc(row_bytes * (size_t)level->height_px);
    float gain = find_gain(level);
    struct srgb_table bytes;
    bool ok;

    if (!rgb) {
        error_set(error, "no memory for %d x %d pixels", level->width_px, level->height_px);
        return false;
    }
    srgb_table_init(&bytes);
    for (int y = 0, last = -1; y < level->height_px; y++) {
        unsigned char *to = rgb + (size_t)y * row_bytes;
        int row = find_nearest(level, y);

        if (row == last)
            memcpy(to, to - row_bytes, row_bytes);
        else
            draw_row(level, row, gain, &bytes, to);
        last = row;
    }
    ok = image_png_quick_write(path, rgb, level->width_px, level->height_px, error);
    free(rgb);
    return ok;
}
