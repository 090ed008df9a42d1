// SPDX-License-Identifier: Apache-2.0
#include "tests/support/png_maker.h"

#include "tests/support/volume_maker.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

struct bytes {
    unsigned char *at; // owned
    size_t size;
};

// The passes of an interlaced image: first pixel and spacing, in x and y.
static const int adam7[7][4] = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
                                {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};

static void append(struct bytes *bytes, const void *more, size_t size)
{
    bytes->at = realloc(bytes->at, bytes->size + size + 1);
    if (!bytes->at) abort();
    if (size > 0) memcpy(bytes->at + bytes->size, more, size);
    bytes->size += size;
}

static void append_number(struct bytes *bytes, unsigned long number)
{
    const unsigned char big[4] = {(unsigned char)(number >> 24), (unsigned char)(number >> 16),
                                  (unsigned char)(number >> 8), (unsigned char)number};

    append(bytes, big, sizeof big);
}

static void append_chunk(struct bytes *bytes, const char *name, const void *content, size_t size)
{
    unsigned long sum;

    append_number(bytes, size);
    append(bytes, name, 4);
    append(bytes, content, size);
    sum = crc32(0, bytes->at + bytes->size - size - 4, (uInt)(size + 4));
    append_number(bytes, sum);
}

int png_maker_channels(enum png_color color)
{
    static const int channels[] = {
        [PNG_GREY] = 1, [PNG_RGB] = 3, [PNG_PALETTE] = 1, [PNG_GREY_ALPHA] = 2, [PNG_RGB_ALPHA] = 4};

    return channels[color];
}

// The values of some pixels of a row, packed from the highest bit on.
static size_t pack_row(const struct png_params *params, int y, int first, int step, unsigned char *packed)
{
    int channels = png_maker_channels(params->color);
    size_t bit = 0;

    for (int x = first; x < params->width; x += step)
        for (int c = 0; c < channels; c++, bit += (size_t)params->bits) {
            unsigned value =
                params->values[((size_t)y * (size_t)params->width + (size_t)x) * (size_t)channels + (size_t)c];

            if (params->bits == 16) {
                packed[bit / 8] = (unsigned char)(value >> 8);
                packed[bit / 8 + 1] = (unsigned char)value;
            } else {
                packed[bit / 8] |= (unsigned char)(value << (8 - (size_t)params->bits - bit % 8));
            }
        }
    return (bit + 7) / 8;
}

// Rows in turn without a filter, as differences from the left, and as differences from above.
static void append_pass(struct bytes *bytes, const struct png_params *params, const int pass[4])
{
    size_t limit = (size_t)params->width * 8,
           stride = (size_t)(png_maker_channels(params->color) * params->bits + 7) / 8;
    unsigned char *rows[2] = {calloc(limit + 1, 1), calloc(limit + 1, 1)}, *filtered = malloc(limit + 1);
    unsigned char filter = 0;

    for (int y = pass[1]; pass[0] < params->width && y < params->height; y += pass[3], filter = (filter + 1) % 3) {
        unsigned char *row = rows[0], *above = rows[1];
        size_t size;

        memset(row, 0, limit + 1);
        size = pack_row(params, y, pass[0], pass[2], row);
        filtered[0] = filter;
        for (size_t i = 0; i < size; i++) {
            unsigned char before = filter == 2 ? above[i] : filter == 1 && i >= stride ? row[i - stride] : 0;

            filtered[1 + i] = (unsigned char)(row[i] - before);
        }
        append(bytes, filtered, size + 1);
        rows[0] = above;
        rows[1] = row;
    }
    free(rows[0]);
    free(rows[1]);
    free(filtered);
}

static void append_pixels(struct bytes *bytes, const struct png_params *params)
{
    static const int whole[4] = {0, 0, 1, 1};
    struct bytes raw = {0};
    unsigned char *packed;
    uLongf size;

    for (int i = 0; i < (params->is_interlaced ? 7 : 1); i++)
        append_pass(&raw, params, params->is_interlaced ? adam7[i] : whole);
    size = compressBound((uLong)raw.size);
    packed = malloc(size);
    if (!packed || compress(packed, &size, raw.at, (uLong)raw.size) != Z_OK) abort();
    append_chunk(bytes, "IDAT", packed, size / 2); // a stream may be cut anywhere
    append_chunk(bytes, "IDAT", packed + size / 2, size - size / 2);
    free(packed);
    free(raw.at);
}

static void append_texts(struct bytes *bytes, const struct png_params *params)
{
    static const unsigned char head[] = {'N', 'o', 't', 'e', 0, 0}; // a key, and the only way to compress
    uLongf size = compressBound((uLong)params->text_size);
    unsigned char *text = calloc(params->text_size + 1, 1), *packed = malloc(sizeof head + size);

    if (!text || !packed) abort();
    memset(text, 'x', params->text_size);
    memcpy(packed, head, sizeof head);
    if (compress(packed + sizeof head, &size, text, (uLong)params->text_size) != Z_OK) abort();
    for (int i = 0; i < params->text_count; i++)
        append_chunk(bytes, "zTXt", packed, sizeof head + size);
    free(packed);
    free(text);
}

unsigned char *png_maker_make(const struct png_params *params, size_t *size_bytes)
{
    static const unsigned char signature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    const unsigned char rest[5] = {(unsigned char)params->bits, (unsigned char)params->color, 0, 0,
                                   params->is_interlaced};
    struct bytes bytes = {0}, header = {0};

    append(&bytes, signature, sizeof signature);
    append_number(&header, (unsigned long)params->width);
    append_number(&header, (unsigned long)params->height);
    append(&header, rest, sizeof rest);
    append_chunk(&bytes, "IHDR", header.at, header.size);
    // A gamma that a reader could be tempted to apply.
    append_chunk(&bytes, "gAMA", "\0\1\206\240", 4);
    if (params->color == PNG_PALETTE) append_chunk(&bytes, "PLTE", params->palette, 3 * (size_t)params->palette_count);
    append_texts(&bytes, params);
    append_pixels(&bytes, params);
    append_chunk(&bytes, "IEND", "", 0);
    free(header.at);
    *size_bytes = bytes.size;
    return bytes.at;
}

void png_maker_write_rgb(const char *path, int width, int height, const unsigned char *rgb)
{
    size_t count = 3 * (size_t)width * (size_t)height;
    uint16_t *values = malloc(count * sizeof *values);
    struct png_params params = {.width = width, .height = height, .color = PNG_RGB, .bits = 8, .values = values};
    unsigned char *bytes;
    size_t size;

    for (size_t i = 0; i < count; i++)
        values[i] = rgb[i];
    bytes = png_maker_make(&params, &size);
    volume_maker_write(path, bytes, size);
    free(bytes);
    free(values);
}
