// SPDX-License-Identifier: Apache-2.0
#include "worker/render/pixel_layout.h"

#include "core/base/alloc.h"

#include <stdlib.h>
#include <string.h>

enum {
    SIDE_MIN = 4,           // its 16 pixels fill the lanes of SIMD units
    SQUARES_PER_THREAD = 4, // a thread with cheap squares takes over others
    COLUMNS = 16            // of squares
};

struct coded {
    uint64_t code;
    uint32_t index;
};

// Moves bit i to bit 2 i.
static uint64_t spread(uint64_t bits)
{
    bits = (bits | bits << 8) & 0x00ff00ffu;
    bits = (bits | bits << 4) & 0x0f0f0f0fu;
    bits = (bits | bits << 2) & 0x33333333u;
    return (bits | bits << 1) & 0x55555555u;
}

// The place along a curve through all points (G. M. Morton, A Computer Oriented Geodetic Data Base, IBM, 1966).
static uint64_t find_code(int x, int y)
{
    return spread((uint64_t)x & 0xffu) | spread((uint64_t)y & 0xffu) << 1 | spread((uint64_t)x >> 8 & 0xffu) << 16 |
           spread((uint64_t)y >> 8 & 0xffu) << 17;
}

static int compare(const void *a, const void *b)
{
    const struct coded *one = a, *other = b;

    if (one->code != other->code) return one->code < other->code ? -1 : 1;
    return one->index < other->index ? -1 : one->index > other->index;
}

static uint32_t *sort(const struct pixel *pixels, size_t count)
{
    struct coded *coded = xmalloc(count * sizeof *coded);
    uint32_t *order = xmalloc(count * sizeof *order);

    for (size_t i = 0; i < count; i++)
        coded[i] = (struct coded){find_code(pixels[i].x, pixels[i].y), (uint32_t)i};
    qsort(coded, count, sizeof *coded, compare);
    for (size_t i = 0; i < count; i++)
        order[i] = coded[i].index;
    free(coded);
    return order;
}

static int find_side(size_t count, int thread_count)
{
    size_t squares = SQUARES_PER_THREAD * (size_t)(thread_count > 0 ? thread_count : 1), side = SIDE_MIN;

    while (side < PIXEL_LAYOUT_PITCH && 4 * side * side * squares <= count)
        side *= 2;
    return (int)side;
}

void pixel_layout_init(struct pixel_layout *layout, const struct pixel *pixels, size_t count, int thread_count)
{
    int side = find_side(count, thread_count), rows;
    size_t area = (size_t)side * (size_t)side;

    *layout = (struct pixel_layout){.pixels = pixels,
                                    .count = count,
                                    .order = sort(pixels, count),
                                    .side = side,
                                    .square_count = (int)((count + area - 1) / area)};
    rows = (layout->square_count + COLUMNS - 1) / COLUMNS;
    layout->width_px = PIXEL_LAYOUT_PITCH * (rows > 1 ? COLUMNS : layout->square_count);
    layout->height_px = PIXEL_LAYOUT_PITCH * rows;
}

void pixel_layout_finish(struct pixel_layout *layout)
{
    free(layout->order);
    *layout = (struct pixel_layout){0};
}

struct pixel pixel_layout_square(const struct pixel_layout *layout, int square)
{
    int columns = layout->width_px / PIXEL_LAYOUT_PITCH;

    return (struct pixel){square % columns * PIXEL_LAYOUT_PITCH, square / columns * PIXEL_LAYOUT_PITCH};
}

size_t pixel_layout_index(const struct pixel_layout *layout, int square, int x, int y)
{
    size_t at = (size_t)square * (size_t)layout->side * (size_t)layout->side + (size_t)find_code(x, y);

    return layout->order[at < layout->count ? at : layout->count - 1];
}

void pixel_layout_gather(const struct pixel_layout *layout, const float *target, size_t size, float *list)
{
    for (int square = 0; square < layout->square_count; square++) {
        struct pixel corner = pixel_layout_square(layout, square);

        for (int y = 0; y < layout->side; y++) {
            const float *row = target + size * ((size_t)(corner.y + y) * (size_t)layout->width_px + (size_t)corner.x);

            for (int x = 0; x < layout->side; x++)
                memcpy(list + size * pixel_layout_index(layout, square, x, y), row + size * (size_t)x,
                       size * sizeof *list);
        }
    }
}
