// A fuzzer's bytes as a volume's file: one that opens is consistent, and is read to its end or fails with a reason.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/error.h"
#include "worker/volume/volume.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Far fewer voxels than a file may have, so that headers that only claim many cost no time.
enum { VOLUME_INPUT_VOXEL_LIMIT = 1 << 20 };

static char volume_input_folder[] = "/tmp/marchd-fuzz-XXXXXX";

static inline void volume_input_require(bool condition)
{
    if (!condition) abort();
}

static inline void volume_input_remove_folder(void)
{
    rmdir(volume_input_folder);
}

// Writes the file `name` into a folder of this process; the path lasts until the next call.
static inline const char *volume_input_write(const char *name, const uint8_t *bytes, size_t size)
{
    static char path[512];
    static bool is_made;
    FILE *file;

    if (!is_made) {
        volume_input_require(mkdtemp(volume_input_folder));
        atexit(volume_input_remove_folder);
        is_made = true;
    }
    snprintf(path, sizeof path, "%s/%s", volume_input_folder, name);
    file = fopen(path, "wb");
    volume_input_require(file && fwrite(bytes, 1, size, file) == size && fclose(file) == 0);
    return path;
}

static inline void volume_input_check_header(const struct volume *volume)
{
    int64_t voxels = 1;

    for (int axis = 0; axis < 3; axis++) {
        volume_input_require(volume->size[axis] >= 1);
        voxels *= volume->size[axis];
        volume_input_require(voxels <= VOLUME_VOXEL_LIMIT);
    }
    volume_input_require(isfinite(volume->slope) && volume->slope != 0.0 && isfinite(volume->intercept));
    for (int i = 0; i < 12; i++)
        volume_input_require(isfinite(volume->index_to_world[i]));
}

static inline void volume_input_read_all(struct volume *volume)
{
    size_t slice = (size_t)volume->size[0] * (size_t)volume->size[1];
    size_t value_size = volume_type_size(volume->type);
    struct error error = {0};
    void *values;
    bool ok = true;

    if (slice * (size_t)volume->size[2] > VOLUME_INPUT_VOXEL_LIMIT) return;
    values = malloc(slice * value_size);
    for (int k = 0; ok && k < volume->size[2]; k++) {
        ok = volume_read(volume, 1, values, &error);
        for (size_t i = 0; ok && volume->type == VOLUME_FLOAT32 && i < slice; i++)
            volume_input_require(isfinite(((float *)values)[i]));
    }
    volume_input_require(ok || error.message[0]);
    free(values);
}

// Opens and reads; removes the file.
static inline void volume_input_try(const struct volume_source *source)
{
    struct error error = {0};
    struct volume *volume;

    if (volume_open(&volume, source, &error)) {
        volume_input_check_header(volume);
        volume_input_read_all(volume);
        volume_close(volume);
    } else {
        volume_input_require(!volume && strncmp(error.message, source->path, strlen(source->path)) == 0);
    }
    unlink(source->path);
}
