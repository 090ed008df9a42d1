// A file of voxels as a stream of slices with a position in the world. It is read once and never held as a whole.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/volume/volume_source.h"
#include "worker/volume/volume_voxels.h"

#include <stdbool.h>

struct error;
struct volume_layout;

// The public fields come from the header and do not change after volume_open.
struct volume {
    int size[3]; // voxels along i, j, k; i fastest
    enum volume_type type;
    double slope, intercept;      // value = slope * stored + intercept; both finite, slope not 0
    double index_to_world[12];    // row-major 3x4, to the centre of voxel (i, j, k) in metres; not singular; may mirror
    int next_slice;               // the one that volume_read reads next
    struct volume_layout *layout; // owned
};

// Opens a file by its name's ending and reads the header. Lengths that the header implies are checked here, before a
// voxel is read. Messages begin with the path. `*volume` is NULL on failure.
bool volume_open(struct volume **volume, const struct volume_source *source, struct error *error);

// Reads the next `slice_count` slices along k, at most as many as are left, in native byte order. `values` has room for
// them.
// A voxel that is NaN or infinite is an error that names it. The last slice also checks that the file ends there.
bool volume_read(struct volume *volume, int slice_count, void *values, struct error *error);
void volume_close(struct volume *volume); // accepts NULL
