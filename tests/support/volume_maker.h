// Small volumes in files of any format: the value of every voxel encodes its index, so that swapped axes show.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/volume/volume_voxels.h"

#include <stdbool.h>

// i + 5 j + 20 k: different at every index of a volume of 5 x 4 x 3 voxels.
double volume_maker_value(int i, int j, int k);

// The voxels of volume_maker_value as they are stored; owned by the caller.
unsigned char *volume_maker_voxels(const int size[3], enum volume_stored stored, bool is_big_endian,
                                   size_t *size_bytes);

// Writes a file; any failure ends the test.
void volume_maker_write(const char *path, const void *bytes, size_t size_bytes);
// Compresses into one gzip member; owned by the caller.
unsigned char *volume_maker_gzip(const void *bytes, size_t size_bytes, size_t *zipped_bytes);
void volume_maker_write_gzip(const char *path, const void *bytes, size_t size_bytes);
// A file of such voxels and nothing else.
void volume_maker_write_raw(const char *path, const int size[3], enum volume_stored stored, bool is_big_endian);
