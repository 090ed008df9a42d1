// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_exr_zip.h"

#include <isa-l/igzip_lib.h>
#include <libdeflate.h>
#include <stdint.h>
#include <stdlib.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

// The level of ISA-L: 0 makes larger files, 3 takes more time, 2 gains nothing (bench/exr_bench).
enum { LEVEL = 1 };

struct image_exr_zip {
    size_t chunk_bytes;
    uint8_t *tables;                              // owned; of the packing; NULL until something is packed
    struct libdeflate_decompressor *decompressor; // owned; NULL until something is unpacked
    uint8_t *bytes, *packed;                      // owned; of chunk_bytes each
};

struct image_exr_zip *image_exr_zip_create(size_t chunk_bytes)
{
    struct image_exr_zip *zip = calloc(1, sizeof *zip);

    if (!zip) return NULL;
    zip->chunk_bytes = chunk_bytes;
    zip->bytes = malloc(chunk_bytes);
    zip->packed = malloc(chunk_bytes);
    if (zip->bytes && zip->packed) return zip;
    image_exr_zip_destroy(zip);
    return NULL;
}

void image_exr_zip_destroy(struct image_exr_zip *zip)
{
    if (!zip) return;
    libdeflate_free_decompressor(zip->decompressor);
    free(zip->tables);
    free(zip->bytes);
    free(zip->packed);
    free(zip);
}

// Copies all bytes of even index, then all of odd index, which puts the high bytes of halves next to each other.
static void part_bytes(uint8_t *restrict to, const uint8_t *restrict from, size_t count)
{
    uint8_t *odd = to + count / 2;

    for (size_t i = 0; i < count / 2; i++) {
        to[i] = from[2 * i];
        odd[i] = from[2 * i + 1];
    }
}

static void join_bytes(uint8_t *restrict to, const uint8_t *restrict from, size_t count)
{
    const uint8_t *odd = from + count / 2;

    for (size_t i = 0; i < count / 2; i++) {
        to[2 * i] = from[i];
        to[2 * i + 1] = odd[i];
    }
}

// Replaces each byte but the first by its difference to the byte before plus 128.
static void take_differences(uint8_t *restrict to, const uint8_t *restrict from, size_t count)
{
    to[0] = from[0];
    for (size_t i = 1; i < count; i++)
        to[i] = (uint8_t)(from[i] - from[i - 1] + 128);
}

// Undoes the differences in place.
static void add_differences(uint8_t *bytes, size_t count)
{
    uint8_t before = 128; // leaves the first byte as it is
    size_t i = 0;

#ifdef __SSE2__
    for (; i + 16 <= count; i += 16) {
        __m128i sums = _mm_add_epi8(_mm_loadu_si128((const __m128i *)(const void *)(bytes + i)), _mm_set1_epi8(-128));

        sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 1));
        sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 2));
        sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 4));
        sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 8));
        sums = _mm_add_epi8(sums, _mm_set1_epi8((char)before));
        _mm_storeu_si128((__m128i *)(void *)(bytes + i), sums);
        before = (uint8_t)(_mm_extract_epi16(sums, 7) >> 8);
    }
#endif
    for (; i < count; i++)
        before = bytes[i] = (uint8_t)(bytes[i] + before - 128);
}

size_t image_exr_zip_pack(struct image_exr_zip *zip, const void *chunk, size_t chunk_bytes, const void **packed)
{
    struct isal_zstream stream;

    if (chunk_bytes == 0 || chunk_bytes > zip->chunk_bytes) return 0;
    if (!zip->tables) zip->tables = malloc(ISAL_DEF_LVL1_DEFAULT);
    if (!zip->tables) return 0;
    part_bytes(zip->packed, chunk, chunk_bytes);
    take_differences(zip->bytes, zip->packed, chunk_bytes);
    *packed = zip->packed;
    isal_deflate_stateless_init(&stream);
    stream.level = LEVEL;
    stream.level_buf = zip->tables;
    stream.level_buf_size = ISAL_DEF_LVL1_DEFAULT;
    stream.gzip_flag = IGZIP_ZLIB;
    stream.end_of_stream = 1;
    stream.next_in = zip->bytes;
    stream.avail_in = (uint32_t)chunk_bytes;
    stream.next_out = zip->packed;
    stream.avail_out = (uint32_t)chunk_bytes - 1;
    return isal_deflate_stateless(&stream) == COMP_OK ? stream.total_out : 0;
}

bool image_exr_zip_unpack(struct image_exr_zip *zip, const void *packed, size_t packed_bytes, void *chunk,
                          size_t chunk_bytes)
{
    if (chunk_bytes % 2 != 0 || chunk_bytes > zip->chunk_bytes) return false;
    if (!zip->decompressor) zip->decompressor = libdeflate_alloc_decompressor();
    if (!zip->decompressor) return false;
    if (libdeflate_zlib_decompress(zip->decompressor, packed, packed_bytes, zip->bytes, chunk_bytes, NULL) !=
        LIBDEFLATE_SUCCESS)
        return false;
    add_differences(zip->bytes, chunk_bytes);
    join_bytes(chunk, zip->bytes, chunk_bytes);
    return true;
}
