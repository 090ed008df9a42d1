// The number types that volume files store, and their conversion into those that voxels have in memory.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

enum { VOLUME_VOXEL_LIMIT = INT32_MAX }; // voxels of a volume: fewer than 2^31

// The types that voxels have in memory. Stored types wider than 16 bits, and signed bytes, become VOLUME_FLOAT32 while
// they are read.
enum volume_type { VOLUME_UINT8, VOLUME_UINT16, VOLUME_INT16, VOLUME_FLOAT32 };

size_t volume_type_size(enum volume_type type); // bytes a voxel

enum volume_stored {
    VOLUME_STORED_UINT8,
    VOLUME_STORED_INT8,
    VOLUME_STORED_UINT16,
    VOLUME_STORED_INT16,
    VOLUME_STORED_UINT32,
    VOLUME_STORED_INT32,
    VOLUME_STORED_UINT64,
    VOLUME_STORED_INT64,
    VOLUME_STORED_FLOAT32,
    VOLUME_STORED_FLOAT64
};

size_t volume_stored_size(enum volume_stored stored); // bytes
const char *volume_stored_name(enum volume_stored stored);
enum volume_type volume_stored_type(enum volume_stored stored); // the type that it is converted to

// Reverses the bytes of each of `count` values.
void volume_voxels_swap(void *values, size_t count, enum volume_stored stored);
// Converts `count` values in native byte order; `to` may be `from` if both types have the same size. Returns the first
// index whose result is not finite, or `count`.
size_t volume_voxels_convert(void *to, const void *from, size_t count, enum volume_stored stored);
