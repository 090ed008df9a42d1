// Packs and unpacks chunks of EXR files for the compressions ZIP and ZIPS.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct image_exr_zip;

// Makes one for chunks of at most `chunk_bytes`, for one thread. NULL when there is no memory.
struct image_exr_zip *image_exr_zip_create(size_t chunk_bytes);
void image_exr_zip_destroy(struct image_exr_zip *zip); // accepts NULL
// Begins a chunk of an even number of bytes, which image_exr_zip_add appends piece by piece: each piece is an even
// number of bytes, and all together are the chunk.
void image_exr_zip_begin(struct image_exr_zip *zip, size_t chunk_bytes);
void image_exr_zip_add(struct image_exr_zip *zip, const void *bytes, size_t size_bytes);
// Ends the chunk. Returns what a file stores, borrowed until the next chunk begins: the packed chunk; or the chunk as
// it is, when packing makes it no smaller or there is no memory for it.
const void *image_exr_zip_end(struct image_exr_zip *zip, size_t *size_bytes);
// Returns false when it is not a chunk of `chunk_bytes`, its checksum is wrong, or there is no memory.
bool image_exr_zip_unpack(struct image_exr_zip *zip, const void *packed, size_t packed_bytes, void *chunk,
                          size_t chunk_bytes);
