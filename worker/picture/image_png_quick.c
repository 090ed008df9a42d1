// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_png_quick.h"

#include "core/base/error.h"
#include "core/base/file.h"

#include <isa-l/crc.h>
#include <isa-l/igzip_lib.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

// A chunk is its length, its name, that many bytes, and a checksum of the name and the bytes. Portable Network Graphics
// Specification, second edition, W3C 2003.
enum { NAME = 4, BODY = 8, AROUND = 12, HEADER = 13, LEVEL = 1 };

static const uint8_t signature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

static void store_number(uint8_t *to, uint32_t number)
{
    for (int i = 0; i < 4; i++)
        to[i] = (uint8_t)(number >> (24 - 8 * i));
}

// Makes a chunk of a body that is in its place. Returns its end.
static uint8_t *end_chunk(uint8_t *chunk, const char name[static 4], uint32_t size_bytes)
{
    store_number(chunk, size_bytes);
    memcpy(chunk + NAME, name, 4);
    store_number(chunk + BODY + size_bytes, crc32_gzip_refl(0, chunk + NAME, 4 + (uint64_t)size_bytes));
    return chunk + AROUND + size_bytes;
}

static void fill_header(uint8_t *body, int width_px, int height_px)
{
    static const uint8_t format[] = {8, 2, 0, 0, 0}; // bits; red, green, blue; the only packing and filters; no passes

    store_number(body, (uint32_t)width_px);
    store_number(body + 4, (uint32_t)height_px);
    memcpy(body + 8, format, sizeof format);
}

// Packs rows, each after a byte 0: it has no filter. 0: there is no memory, or no room.
static uint32_t pack(const uint8_t *rows, size_t size_bytes, uint8_t *packed, size_t room)
{
    uint8_t *tables = malloc(ISAL_DEF_LVL1_DEFAULT);
    struct isal_zstream stream;
    bool ok;

    if (!tables) return 0;
    isal_deflate_stateless_init(&stream);
    stream.level = LEVEL;
    stream.level_buf = tables;
    stream.level_buf_size = ISAL_DEF_LVL1_DEFAULT;
    stream.gzip_flag = IGZIP_ZLIB;
    stream.end_of_stream = 1;
    stream.next_in = (uint8_t *)rows;
    stream.avail_in = (uint32_t)size_bytes;
    stream.next_out = packed;
    stream.avail_out = (uint32_t)room;
    ok = isal_deflate_stateless(&stream) == COMP_OK;
    free(tables);
    return ok ? stream.total_out : 0;
}

static bool write_rows(const char *path, const uint8_t *rows, int width_px, int height_px, struct error *error)
{
    size_t size_bytes = (1 + 3 * (size_t)width_px) * (size_t)height_px;
    size_t room = size_bytes + size_bytes / 64 + 1024; // stored blocks have five bytes more in 65535
    uint8_t *file = malloc(sizeof signature + AROUND + HEADER + AROUND + room + AROUND), *end;
    uint32_t packed_bytes = 0;
    bool ok = false;

    if (file) {
        memcpy(file, signature, sizeof signature);
        end = file + sizeof signature;
        fill_header(end + BODY, width_px, height_px);
        end = end_chunk(end, "IHDR", HEADER);
        packed_bytes = pack(rows, size_bytes, end + BODY, room);
    }
    if (packed_bytes > 0) {
        end = end_chunk(end, "IDAT", packed_bytes);
        end = end_chunk(end, "IEND", 0);
        ok = file_replace(path, file, (size_t)(end - file), error);
    } else {
        error_set(error, "no memory for %d x %d pixels", width_px, height_px);
    }
    free(file);
    return ok;
}

bool image_png_quick_write(const char *path, const unsigned char *rgb, int width_px, int height_px, struct error *error)
{
    size_t row_bytes = 3 * (size_t)width_px;
    uint8_t *rows = malloc((1 + row_bytes) * (size_t)height_px);
    bool ok;

    if (!rows) {
        error_set(error, "no memory for %d x %d pixels", width_px, height_px);
        return false;
    }
    for (int y = 0; y < height_px; y++) {
        uint8_t *row = rows + (size_t)y * (1 + row_bytes);

        row[0] = 0;
        memcpy(row + 1, rgb + (size_t)y * row_bytes, row_bytes);
    }
    ok = write_rows(path, rows, width_px, height_px, error);
    free(rows);
    return ok;
}
