// The contents of a volume file's header, whatever its format, and the stream positioned at the first voxel.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/volume/volume_source.h"
#include "worker/volume/volume_voxels.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct volume_stream;

struct volume_layout {
    int size[3];
    enum volume_stored stored;
    bool is_big_endian;
    double slope, intercept;
    double index_to_world[12];    // m
    struct volume_stream *stream; // owned
    void *staging;                // owned; a buffer for stored values whose size changes in conversion
};

// Each reader fills an empty layout. The caller finishes it, on failure too.
bool volume_raw_open(struct volume_layout *layout, const struct volume_source *source, struct error *error);
bool volume_nrrd_open(struct volume_layout *layout, const struct volume_source *source, struct error *error);
bool volume_nifti_open(struct volume_layout *layout, const struct volume_source *source, struct error *error);
bool volume_nifti_gzip_open(struct volume_layout *layout, const struct volume_source *source, struct error *error);

void volume_layout_finish(struct volume_layout *layout);

// Sets the size from unchecked numbers; `field` is their name in the file.
bool volume_layout_set_size(struct volume_layout *layout, const char *field, const int64_t size[3],
                            struct error *error);
int64_t volume_layout_voxels(const struct volume_layout *layout);
int64_t volume_layout_bytes(const struct volume_layout *layout); // as stored
// Checks that the rest of the file is exactly the voxels. For compressed files only reading them can tell.
bool volume_layout_check_length(const struct volume_layout *layout, struct error *error);
