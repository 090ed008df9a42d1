// SPDX-License-Identifier: Apache-2.0
#include "tests/support/volume_maker.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

double volume_maker_value(int i, int j, int k)
{
    return i + 5 * j + 20 * k;
}

static void store(unsigned char *to, double value, enum volume_stored stored)
{
    union {
        uint8_t u8;
        int8_t i8;
        uint16_t u16;
        int16_t i16;
        uint32_t u32;
        int32_t i32;
        uint64_t u64;
        int64_t i64;
        float f32;
        double f64;
    } number;

    switch (stored) {
    case VOLUME_STORED_UINT8:
        number.u8 = (uint8_t)value;
        break;
    case VOLUME_STORED_INT8:
        number.i8 = (int8_t)value;
        break;
    case VOLUME_STORED_UINT16:
        number.u16 = (uint16_t)value;
        break;
    case VOLUME_STORED_INT16:
        number.i16 = (int16_t)value;
        break;
    case VOLUME_STORED_UINT32:
        number.u32 = (uint32_t)value;
        break;
    case VOLUME_STORED_INT32:
        number.i32 = (int32_t)value;
        break;
    case VOLUME_STORED_UINT64:
        number.u64 = (uint64_t)value;
        break;
    case VOLUME_STORED_INT64:
        number.i64 = (int64_t)value;
        break;
    case VOLUME_STORED_FLOAT32:
        number.f32 = (float)value;
        break;
    case VOLUME_STORED_FLOAT64:
        number.f64 = value;
        break;
    }
    memcpy(to, &number, volume_stored_size(stored));
}

unsigned char *volume_maker_voxels(const int size[3], enum volume_stored stored, bool is_big_endian, size_t *size_bytes)
{
    size_t value_size = volume_stored_size(stored);
    unsigned char *bytes;
    unsigned char *at;

    *size_bytes = (size_t)size[0] * (size_t)size[1] * (size_t)size[2] * value_size;
    bytes = at = malloc(*size_bytes);
    if (!bytes) abort();
    for (int k = 0; k < size[2]; k++)
        for (int j = 0; j < size[1]; j++)
            for (int i = 0; i < size[0]; i++, at += value_size) {
                store(at, volume_maker_value(i, j, k), stored);
                for (size_t a = 0, b = value_size - 1; is_big_endian && a < b; a++, b--) {
                    unsigned char byte = at[a];

                    at[a] = at[b];
                    at[b] = byte;
                }
            }
    return bytes;
}

void volume_maker_write(const char *path, const void *bytes, size_t size_bytes)
{
    FILE *file = fopen(path, "wb");

    if (!file || fwrite(bytes, 1, size_bytes, file) != size_bytes || fclose(file) != 0) {
        perror(path);
        abort();
    }
}

unsigned char *volume_maker_gzip(const void *bytes, size_t size_bytes, size_t *zipped_bytes)
{
    z_stream zlib = {.next_in = (unsigned char *)bytes, .avail_in = (unsigned int)size_bytes};
    unsigned char *zipped = malloc(size_bytes + 1024);

    // A window of 32 KiB and gzip's own header and trailer.
    if (!zipped || deflateInit2(&zlib, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK) abort();
    zlib.next_out = zipped;
    zlib.avail_out = (unsigned int)size_bytes + 1024;
    if (deflate(&zlib, Z_FINISH) != Z_STREAM_END) abort();
    *zipped_bytes = zlib.total_out;
    deflateEnd(&zlib);
    return zipped;
}

void volume_maker_write_gzip(const char *path, const void *bytes, size_t size_bytes)
{
    size_t zipped_bytes;
    unsigned char *zipped = volume_maker_gzip(bytes, size_bytes, &zipped_bytes);

    volume_maker_write(path, zipped, zipped_bytes);
    free(zipped);
}

void volume_maker_write_raw(const char *path, const int size[3], enum volume_stored stored, bool is_big_endian)
{
    size_t size_bytes;
    unsigned char *bytes = volume_maker_voxels(size, stored, is_big_endian, &size_bytes);

    volume_maker_write(path, bytes, size_bytes);
    free(bytes);
}
