// Assertions for tests of volume readers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/volume/volume.h"

// Opens and expects success; close it with volume_close.
struct volume *volume_check_open(const struct volume_source *source);
// The stored numbers are those of volume_maker_value; read in portions of 1, 2, 3... slices.
void volume_check_voxels(struct volume *volume);
// The centre of voxel (i, j, k) lies at (x, y, z) metres, within `tolerance`.
void volume_check_place(const struct volume *volume, const int index[3], const double metres[3], double tolerance);
// Refused while it is opened or read, with a message that begins with `path` (NULL: the source's) and has `expected`.
void volume_check_refused(const struct volume_source *source, const char *path, const char *expected);
