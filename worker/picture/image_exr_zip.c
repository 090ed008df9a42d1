// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_exr_zip.h"

#include <assert.h>
#include <isa-l/igzip_lib.h>
#include <libdeflate.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum {
    LEVEL = 1,         // of ISA-L: 0 makes larger files, 3 takes more time, 2 gains nothing (bench/exr_bench)
    KEPT_BYTES = 16384 // packed chunks that are no larger are kept: neighbours in an empty part of a picture are equal
};

struct image_exr_zip {
    size_t chunk_bytes;                           // at most
    uint8_t *tables;                              // owned; of the packing; NULL until something is packed
    struct libdeflate_decompressor *decompressor; // owned; NULL until something is unpacked
    // The chunk's bytes of even index, then those of odd index, which puts the high bytes of halves next to each other;
    // when packing, each byte but the first less the byte before it, plus 128.
    uint8_t *bytes;             // owned
    uint8_t *packed;            // owned; of chunk_bytes, as is the last
    size_t size_bytes, added;   // of the chunk that is being packed
    uint8_t even, odd;          // the last two bytes of those added
    size_t kept, kept_unpacked; // `packed` has a packed chunk of so many bytes, and `bytes` what it is; 0: it has none
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

// Of x86-64's and ARM's SIMD units. Compilers make slower code of loops over bytes, or none.
typedef uint8_t sixteen __attribute__((vector_size(16)));
static const sixteen NOUGHTS;

static sixteen load(const uint8_t *from)
{
    sixteen loaded;

    memcpy(&loaded, from, sizeof loaded);
    return loaded;
}

static void store(uint8_t *to, sixteen bytes)
{
    memcpy(to, &bytes, sizeof bytes);
}

static uint8_t difference(uint8_t byte, uint8_t before)
{
    return (uint8_t)(byte - before + 128);
}

// Parts bytes by their index. Each becomes its difference to the byte two before it, which is the one before it then.
// The first two are left out.
static void part_differences(uint8_t *restrict even, uint8_t *restrict odd, const uint8_t *restrict from, size_t count)
{
    size_t i = 1;

    for (; i + 16 <= count / 2; i += 16) {
        const uint8_t *at = from + 2 * i;
        sixteen a = load(at) - load(at - 2) + 128, b = load(at + 16) - load(at + 14) + 128;

        store(even + i, __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30));
        store(odd + i, __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31));
    }
    for (; i < count / 2; i++) {
        even[i] = difference(from[2 * i], from[2 * i - 2]);
        odd[i] = difference(from[2 * i + 1], from[2 * i - 1]);
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

// Undoes the differences in place. Sums of sixteen wait for no sums before them: only their last byte goes on.
static void add_differences(uint8_t *bytes, size_t count)
{
    sixteen before = NOUGHTS + 128; // leaves the first byte as it is
    size_t i = 0;

    for (; i + 16 <= count; i += 16) {
        sixteen sums = load(bytes + i) + 128;

        sums += __builtin_shufflevector(NOUGHTS, sums, 0, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30);
        sums += __builtin_shufflevector(NOUGHTS, sums, 0, 0, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29);
        sums += __builtin_shufflevector(NOUGHTS, sums, 0, 0, 0, 0, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27);
        sums += __builtin_shufflevector(NOUGHTS, sums, 0, 0, 0, 0, 0, 0, 0, 0, 16, 17, 18, 19, 20, 21, 22, 23);
        store(bytes + i, sums + before);
        before += __builtin_shufflevector(sums, sums, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15);
    }
    for (uint8_t last = before[0]; i < count; i++)
        last = bytes[i] = (uint8_t)(bytes[i] + last - 128);
}

void image_exr_zip_begin(struct image_exr_zip *zip, size_t chunk_bytes)
{
    assert(chunk_bytes > 0 && chunk_bytes % 2 == 0 && chunk_bytes <= zip->chunk_bytes);
    zip->size_bytes = chunk_bytes;
    zip->added = 0;
    zip->even = 128; // leaves the first byte as it is
    zip->odd = 0;    // what is before the first byte of odd index is known at the end
    zip->kept = 0;
}

void image_exr_zip_add(struct image_exr_zip *zip, const void *bytes, size_t size_bytes)
{
    const uint8_t *from = bytes;
    uint8_t *even = zip->bytes + zip->added / 2, *odd = even + zip->size_bytes / 2;

    if (size_bytes == 0) return;
    assert(size_bytes % 2 == 0 && zip->added + size_bytes <= zip->size_bytes);
    even[0] = difference(from[0], zip->even);
    odd[0] = difference(from[1], zip->odd);
    part_differences(even, odd, from, size_bytes);
    zip->added += size_bytes;
    zip->even = from[size_bytes - 2];
    zip->odd = from[size_bytes - 1];
}

static size_t pack(struct image_exr_zip *zip)
{
    struct isal_zstream stream;

    if (!zip->tables) zip->tables = malloc(ISAL_DEF_LVL1_DEFAULT);
    if (!zip->tables) return 0;
    isal_deflate_stateless_init(&stream);
    stream.level = LEVEL;
    stream.level_buf = zip->tables;
    stream.level_buf_size = ISAL_DEF_LVL1_DEFAULT;
    stream.gzip_flag = IGZIP_ZLIB;
    stream.end_of_stream = 1;
    stream.next_in = zip->bytes;
    stream.avail_in = (uint32_t)zip->size_bytes;
    stream.next_out = zip->packed;
    stream.avail_out = (uint32_t)zip->size_bytes - 1;
    return isal_deflate_stateless(&stream) == COMP_OK ? stream.total_out : 0;
}

const void *image_exr_zip_end(struct image_exr_zip *zip, size_t *size_bytes)
{
    assert(zip->added == zip->size_bytes);
    zip->bytes[zip->size_bytes / 2] -= zip->even;
    *size_bytes = pack(zip);
    if (*size_bytes > 0) return zip->packed;
    *size_bytes = zip->size_bytes;
    add_differences(zip->bytes, zip->size_bytes);
    join_bytes(zip->packed, zip->bytes, zip->size_bytes);
    return zip->packed;
}

static bool is_kept(const struct image_exr_zip *zip, const void *packed, size_t packed_bytes, size_t chunk_bytes)
{
    return zip->kept == packed_bytes && zip->kept_unpacked == chunk_bytes && packed_bytes > 0 &&
           memcmp(zip->packed, packed, packed_bytes) == 0;
}

static bool unpack(struct image_exr_zip *zip, const void *packed, size_t packed_bytes, size_t chunk_bytes)
{
    zip->kept = 0;
    if (!zip->decompressor) zip->decompressor = libdeflate_alloc_decompressor();
    if (!zip->decompressor) return false;
    if (libdeflate_zlib_decompress(zip->decompressor, packed, packed_bytes, zip->bytes, chunk_bytes, NULL) !=
        LIBDEFLATE_SUCCESS)
        return false;
    add_differences(zip->bytes, chunk_bytes);
    if (packed_bytes > KEPT_BYTES || packed_bytes > zip->chunk_bytes) return true;
    memcpy(zip->packed, packed, packed_bytes);
    zip->kept = packed_bytes;
    zip->kept_unpacked = chunk_bytes;
    return true;
}

bool image_exr_zip_unpack(struct image_exr_zip *zip, const void *packed, size_t packed_bytes, void *chunk,
                          size_t chunk_bytes)
{
    if (chunk_bytes % 2 != 0 || chunk_bytes > zip->chunk_bytes) return false;
    if (!is_kept(zip, packed, packed_bytes, chunk_bytes) && !unpack(zip, packed, packed_bytes, chunk_bytes))
        return false;
    join_bytes(chunk, zip->bytes, chunk_bytes);
    return true;
}
