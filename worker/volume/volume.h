// A file of voxels (raw, NRRD, NIfTI) as a stream of slices with a place in the world: read once, never held as a whole.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/volume/volume_source.h"
#include "worker/volume/volume_voxels.h"

#include <stdbool.h>

struct error;
struct volume_layout;

// Public fields are the header's; nothing changes them after volume_open.
struct volume {
    int size[3]; // voxels along i, j, k; i fastest
    enum volume_type type;
    double slope, intercept;   // value = slope * stored + intercept; both finite, slope not 0
    double index_to_world[12]; // row-major 3x4: metres of the centre of voxel (i, j, k); not singular; may be mirrored
    int next_slice;            // the first that volume_read has not given yet
    struct volume_layout *layout; // owned
};

// Opens by the name's ending and reads the header. Any length that a file must have is checked here, before a voxel is
// read. Messages begin with the path. `*volume` is NULL on failure.
bool volume_open(struct volume **volume, const struct volume_source *source, struct error *error);

// The next `slice_count` slices along k, at most as many as are left, in native byte order; `values` has room for them.
// A voxel that is NaN or infinite is an error that names it. With the last slice the file's end is checked.
bool volume_read(struct volume *volume, int slice_count, void *values, struct error *error);
void volume_close(struct volume *volume); // accepts NULL
