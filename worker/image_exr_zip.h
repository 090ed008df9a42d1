// Packs a chunk of an EXR file as its ZIP and ZIPS compressions have it.
#pragma once

#include <stddef.h>

struct image_exr_zip;

// For chunks of at most `chunk_bytes`. NULL when memory is out. One a thread.
struct image_exr_zip *image_exr_zip_create(size_t chunk_bytes);
void image_exr_zip_destroy(struct image_exr_zip *zip); // accepts NULL
// `chunk_bytes` is even, as values of 2 or 4 bytes make it. The size of what `packed` then points to, borrowed until the next call; 0 when it would not be smaller than the chunk.
size_t image_exr_zip_pack(struct image_exr_zip *zip, const void *chunk, size_t chunk_bytes, const void **packed);
