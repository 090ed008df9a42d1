// Packs and unpacks chunks of EXR files for the compressions ZIP and ZIPS.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct image_exr_zip;

// Makes one for chunks of at most `chunk_bytes`, for one thread. NULL when there is no memory.
struct image_exr_zip *image_exr_zip_create(size_t chunk_bytes);
void image_exr_zip_destroy(struct image_exr_zip *zip); // accepts NULL
// Returns the size of the packed chunk, which `packed` then points to, borrowed until the next call; 0 when it is not
// smaller than the chunk, or there is no memory. `chunk_bytes` is even.
size_t image_exr_zip_pack(struct image_exr_zip *zip, const void *chunk, size_t chunk_bytes, const void **packed);
// Returns false when it is not a chunk of `chunk_bytes`, its checksum is wrong, or there is no memory.
bool image_exr_zip_unpack(struct image_exr_zip *zip, const void *packed, size_t packed_bytes, void *chunk,
                          size_t chunk_bytes);
