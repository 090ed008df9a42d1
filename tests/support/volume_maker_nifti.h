// NIfTI files for tests, by the names of the standard's fields (nifti1.h, nifti2.h).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/volume/volume_voxels.h"

#include <stdbool.h>

struct volume_maker_nifti {
    int version; // 1 or 2
    bool is_big_endian;
    size_t size_bytes;
    unsigned char *bytes; // owned; the whole file
};

// A valid file of volume_maker_voxels: voxels of 1 mm by pixdim alone.
void volume_maker_nifti_init(struct volume_maker_nifti *nifti, int version, bool is_big_endian, const int size[3],
                             enum volume_stored stored);
void volume_maker_nifti_finish(struct volume_maker_nifti *nifti);
// Overwrites one number: "dim", 1, 5.0 is dim[1] = 5. An unknown name ends the program.
void volume_maker_nifti_set(struct volume_maker_nifti *nifti, const char *field, size_t index, double number);
