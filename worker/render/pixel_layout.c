// SPDX-License-Identifier: Apache-2.0
#include "worker/render/pixel_layout.h"

#include "core/base/alloc.h"

#include <stdlib.h>
#include <string.h>

enum {
    SIDE_MIN = 4,           // its 16 pixels fill the lanes of SIMD units
    SQUARES_PER_THREAD = 4, // a thread with cheap squares takes over others
    COLUMNS = 16,           // of squares
    DIGIT_BITS = 8,
    DIGIT_MASK = (1 << DIGIT_BITS) - 1
};

struct coded {
    uint32_t code, index;
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

// Sorts by one digit of the code, which starts at bit `shift`; equal digits keep their order.
static void sort_digit(const struct coded *from, struct coded *to, size_t count, int shift)
{
    size_t begins[1 << DIGIT_BITS] = {0}, begin = 0;

    for (size_t i = 0; i < count; i++)
        begins[from[i].code >> shift & DIGIT_MASK]++;
    for (size_t digit = 0; digit <= DIGIT_MASK; digit++) {
        size_t end = begin + begins[digit];

        begins[digit] = begin;
        begin = end;
    }
    for (size_t i = 0; i < count; i++)
        to[begins[from[i].code >> shift & DIGIT_MASK]++] = from[i];
}

// By digits, the last one first: lists of a frame's size are sorted, too, and comparing would take a fifth of a cheap
// pixel's time.
static uint32_t *sort(const struct pixel *pixels, size_t count)
{
    struct coded *coded = xmalloc(count * sizeof *coded), *sorted = xmalloc(count * sizeof *sorted);
    uint32_t *order = xmalloc(count * sizeof *order);

    for (size_t i = 0; i < count; i++)
        coded[i] = (struct coded){(uint32_t)find_code(pixels[i].x, pixels[i].y), (uint32_t)i};
    for (int shift = 0; shift < 32; shift += 2 * DIGIT_BITS) {
        sort_digit(coded, sorted, count, shift);
        sort_digit(sorted, coded, count, shift + DIGIT_BITS);
    }
    for (size_t i = 0; i < count; i++)
        order[i] = coded[i].index;
    free(sorted);
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

static int count_columns(const struct pixel_layout *layout)
{
    return layout->width_px / PIXEL_LAYOUT_PITCH;
}

struct pixel pixel_layout_square(const struct pixel_layout *layout, int square)
{
    int columns = count_columns(layout);

    return (struct pixel){square % columns * PIXEL_LAYOUT_PITCH, square / columns * PIXEL_LAYOUT_PITCH};
}

size_t pixel_layout_index(const struct pixel_layout *layout, int square, int x, int y)
{
    size_t at = (size_t)square * (size_t)layout->side * (size_t)layout->side + (size_t)find_code(x, y);

    return layout->order[at < layout->count ? at : layout->count - 1];
}

int pixel_layout_strip_count(const struct pixel_layout *layout)
{
    return layout->height_px / PIXEL_LAYOUT_PITCH;
}

int pixel_layout_strip_y(int strip)
{
    return strip * PIXEL_LAYOUT_PITCH;
}

void pixel_layout_gather(const struct pixel_layout *layout, int strip, const void *values, size_t size, void *list)
{
    int columns = count_columns(layout), end = (strip + 1) * columns;
    const char *from = values;
    char *to = list;

    for (int square = strip * columns; square < end && square < layout->square_count; square++) {
        int left = pixel_layout_square(layout, square).x;

        for (int y = 0; y < layout->side; y++) {
            const char *row = from + size * ((size_t)y * (size_t)layout->width_px + (size_t)left);

            for (int x = 0; x < layout->side; x++)
                memcpy(to + size * pixel_layout_index(layout, square, x, y), row + size * (size_t)x, size);
        }
    }
}
