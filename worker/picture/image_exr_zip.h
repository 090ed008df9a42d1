// Packs and unpacks a chunk of an EXR file as its ZIP and ZIPS compressions have it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct image_exr_zip;

// For chunks of at most `chunk_bytes`. NULL when memory is out. One a thread.
struct image_exr_zip *image_exr_zip_create(size_t chunk_bytes);
void image_exr_zip_destroy(struct image_exr_zip *zip); // accepts NULL
// `chunk_bytes` is even, as values of 2 or 4 bytes make it. The size of what `packed` then points to, borrowed until the
// next call; 0 when it would not be smaller than the chunk, or memory is out.
size_t image_exr_zip_pack(struct image_exr_zip *zip, const void *chunk, size_t chunk_bytes, const void **packed);
// False when it is not a chunk of `chunk_bytes`, its checksum is another, or memory is out.
bool image_exr_zip_unpack(struct image_exr_zip *zip, const void *packed, size_t packed_bytes, void *chunk,
                          size_t chunk_bytes);
