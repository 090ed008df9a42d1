// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_exr_line.h"

#include "worker/picture/half_row.h"
#include "worker/picture/image.h"

#include <string.h>

enum { RGBA_COUNT = 4, TRANSMITTANCE_COUNT = 3 };

static size_t value_bytes(bool is_half)
{
    return is_half ? 2 : 4;
}

size_t image_exr_line_bytes(const struct image *image, bool is_half)
{
    size_t colours = RGBA_COUNT + (image->transmittance ? TRANSMITTANCE_COUNT : 0);

    return (size_t)image->width_px * (colours * value_bytes(is_half) + (image->depth ? sizeof *image->depth : 0));
}

static void take_floats(char *to, const float *pixels, size_t count)
{
    for (size_t x = 0; x < count; x++)
        memcpy(to + x * sizeof *pixels, pixels + x * HALF_ROW_PLANES, sizeof *pixels);
}

// Writes the first `channel_count` values of pixels, the last channel first. Returns the end.
static char *pack_colours(char *line, const float *pixels, size_t count, size_t channel_count, bool is_half)
{
    uint16_t *planes[HALF_ROW_PLANES] = {0};
    size_t plane_bytes = count * value_bytes(is_half);

    for (size_t i = 0; i < channel_count; i++) {
        char *plane = line + (channel_count - 1 - i) * plane_bytes;

        planes[i] = (void *)plane;
        if (!is_half) take_floats(plane, pixels + i, count);
    }
    if (is_half) half_row_split(planes, pixels, count);
    return line + channel_count * plane_bytes;
}

void image_exr_line_pack(const struct image *image, bool is_half, int y, void *line)
{
    size_t width = (size_t)image->width_px, first = (size_t)y * width;
    char *to = pack_colours(line, image->rgba + first * HALF_ROW_PLANES, width, RGBA_COUNT, is_half);

    if (image->depth) {
        memcpy(to, image->depth + first, width * sizeof *image->depth);
        to += width * sizeof *image->depth;
    }
    if (image->transmittance)
        pack_colours(to, image->transmittance + first * HALF_ROW_PLANES, width, TRANSMITTANCE_COUNT, is_half);
}
