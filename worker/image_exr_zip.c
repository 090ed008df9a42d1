#include "worker/image_exr_zip.h"

#include <libdeflate.h>
#include <stdint.h>
#include <stdlib.h>

// Of libdeflate: what is above takes longer than it saves bytes (bench/exr_bench).
enum { LEVEL = 3 };

struct image_exr_zip {
    struct libdeflate_compressor *compressor; // owned
    uint8_t *bytes, *packed;                  // owned; of chunk_bytes each
};

struct image_exr_zip *image_exr_zip_create(size_t chunk_bytes)
{
    struct image_exr_zip *zip = calloc(1, sizeof *zip);

    if (!zip) return NULL;
    zip->compressor = libdeflate_alloc_compressor(LEVEL);
    zip->bytes = malloc(chunk_bytes);
    zip->packed = malloc(chunk_bytes);
    if (zip->compressor && zip->bytes && zip->packed) return zip;
    image_exr_zip_destroy(zip);
    return NULL;
}

void image_exr_zip_destroy(struct image_exr_zip *zip)
{
    if (!zip) return;
    libdeflate_free_compressor(zip->compressor);
    free(zip->bytes);
    free(zip->packed);
    free(zip);
}

// All bytes of even index, then all of odd index: a half's two bytes part, and like comes to like.
static void part_bytes(uint8_t *to, const uint8_t *from, size_t count)
{
    uint8_t *odd = to + count / 2;

    for (size_t i = 0; i < count / 2; i++) {
        to[i] = from[2 * i];
        odd[i] = from[2 * i + 1];
    }
}

// Each byte but the first as its difference to the one before, 128 for none. From the end, so that the one before is there.
static void take_differences(uint8_t *bytes, size_t count)
{
    for (size_t i = count; i-- > 1;)
        bytes[i] = (uint8_t)(bytes[i] - bytes[i - 1] + 128);
}

size_t image_exr_zip_pack(struct image_exr_zip *zip, const void *chunk, size_t chunk_bytes, const void **packed)
{
    if (chunk_bytes == 0) return 0;
    part_bytes(zip->bytes, chunk, chunk_bytes);
    take_differences(zip->bytes, chunk_bytes);
    *packed = zip->packed;
    return libdeflate_zlib_compress(zip->compressor, zip->bytes, chunk_bytes, zip->packed, chunk_bytes - 1);
}
