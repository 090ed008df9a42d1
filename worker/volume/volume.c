// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/scene/file_format.h"
#include "core/scene/input_path.h"
#include "worker/volume/volume_layout.h"
#include "worker/volume/volume_memory.h"
#include "worker/volume/volume_placement.h"
#include "worker/volume/volume_stream.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// The number of values converted at once: few enough to stay in the cache while they are read, swapped and checked.
enum { CHUNK_VALUES = 64 * 1024 };

typedef bool open_format(struct volume_layout *layout, const struct volume_source *source, struct error *error);

// Each format with FILE_GRID_RAW or FILE_GRID_DENSE in core/scene/file_format.c is a row.
static const struct {
    const char *ending;
    open_format *open;
} formats[] = {
    {".raw", volume_raw_open},           // voxels alone
    {".nrrd", volume_nrrd_open},         // NRRD: header and voxels
    {".nhdr", volume_nrrd_open},         // NRRD: a header that names the file of voxels
    {".nii", volume_nifti_open},         // NIfTI-1 and NIfTI-2
    {".nii.gz", volume_nifti_gzip_open}, // the same, compressed as a whole
};

enum { FORMAT_COUNT = sizeof formats / sizeof formats[0] };

static bool is_raw_given(const struct scene_raw *raw)
{
    return raw->size[0] || raw->size[1] || raw->size[2] || raw->has_type || raw->is_big_endian || raw->skip_bytes;
}

// Fails for a name that no row of `formats` has.
static bool fail_ending(const char *path, struct error *error)
{
    char *endings = file_format_list_endings(FILE_GRID_RAW | FILE_GRID_DENSE, "or");

    if (input_path_has_ending(path, ".hdr") || input_path_has_ending(path, ".img"))
        error_set(error, "header and voxels are in two files (.hdr and .img): join them into one .nii first");
    else
        error_set(error, "expected a name that ends in %s", endings);
    free(endings);
    return false;
}

static bool open_by_name(struct volume_layout *layout, const struct volume_source *source, struct error *error)
{
    for (size_t i = 0; i < FORMAT_COUNT; i++) {
        if (!input_path_has_ending(source->path, formats[i].ending)) continue;
        if (!file_format_is(source->path, FILE_GRID_RAW) && is_raw_given(&source->raw)) {
            error_set(error, "size, type, byte_order and skip_bytes are for raw files; a %s file says them itself",
                      formats[i].ending);
            return false;
        }
        return formats[i].open(layout, source, error);
    }
    return fail_ending(source->path, error);
}

static bool check_memory(const struct volume_layout *layout, struct error *error)
{
    size_t value_size = volume_type_size(volume_stored_type(layout->stored));

    return volume_memory_check(volume_layout_voxels(layout) * (int64_t)value_size, volume_memory_limit(), error);
}

static bool set_placement(struct volume_layout *layout, const struct volume_source *source, struct error *error)
{
    const double *spacing = source->spacing;

    if (!volume_placement_check(layout->index_to_world, error)) return false;
    if (spacing[0] == 0.0 && spacing[1] == 0.0 && spacing[2] == 0.0) return true;
    for (int axis = 0; axis < 3; axis++) {
        if (spacing[axis] > 0.0 && isfinite(spacing[axis])) continue;
        error_set(error, "spacing: expected sides of voxels above 0 m, got %g along %c", spacing[axis], "ijk"[axis]);
        return false;
    }
    volume_placement_respace(layout->index_to_world, layout->size, spacing);
    return volume_placement_check(layout->index_to_world, error);
}

bool volume_open(struct volume **volume, const struct volume_source *source, struct error *error)
{
    struct volume_layout *layout = xcalloc(1, sizeof *layout);

    *volume = NULL;
    if (!open_by_name(layout, source, error) || !set_placement(layout, source, error) || !check_memory(layout, error)) {
        error_prefix(error, "%s", source->path);
        volume_layout_finish(layout);
        free(layout);
        return false;
    }
    *volume = xcalloc(1, sizeof **volume);
    **volume = (struct volume){.type = volume_stored_type(layout->stored),
                               .slope = layout->slope,
                               .intercept = layout->intercept,
                               .layout = layout};
    memcpy((*volume)->size, layout->size, sizeof layout->size);
    memcpy((*volume)->index_to_world, layout->index_to_world, sizeof layout->index_to_world);
    return true;
}

void volume_close(struct volume *volume)
{
    if (!volume) return;
    volume_layout_finish(volume->layout);
    free(volume->layout);
    free(volume);
}

static bool is_native_order(bool is_big_endian)
{
    return is_big_endian == (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
}

static void set_voxel_error(const struct volume *volume, int64_t index, struct error *error)
{
    int64_t i = index % volume->size[0];
    int64_t j = index / volume->size[0] % volume->size[1];
    int64_t k = index / volume->size[0] / volume->size[1];

    error_set(error,
              "voxel (%" PRId64 ", %" PRId64 ", %" PRId64 ") is no finite number (or too large for one of 32 bits)", i,
              j, k);
}

// Reads the next `count` values, of which the first is the file's `index`th.
static bool read_chunk(struct volume *volume, int64_t index, size_t count, void *values, struct error *error)
{
    struct volume_layout *layout = volume->layout;
    size_t stored_size = volume_stored_size(layout->stored);
    void *bytes = values;
    size_t bad;

    if (stored_size != volume_type_size(volume->type)) {
        if (!layout->staging) layout->staging = xmalloc(CHUNK_VALUES * sizeof(double));
        bytes = layout->staging;
    }
    if (!volume_stream_read(layout->stream, bytes, count * stored_size, error)) return false;
    if (!is_native_order(layout->is_big_endian)) volume_voxels_swap(bytes, count, layout->stored);
    bad = volume_voxels_convert(values, bytes, count, layout->stored);
    if (bad == count) return true;
    set_voxel_error(volume, index + (int64_t)bad, error);
    return false;
}

bool volume_read(struct volume *volume, int slice_count, void *values, struct error *error)
{
    int64_t slice = (int64_t)volume->size[0] * volume->size[1];
    int64_t count = slice * slice_count;
    size_t value_size = volume_type_size(volume->type);
    bool ok = true;

    assert(slice_count >= 0 && slice_count <= volume->size[2] - volume->next_slice);
    for (int64_t done = 0; ok && done < count; done += CHUNK_VALUES) {
        int64_t chunk = count - done < CHUNK_VALUES ? count - done : CHUNK_VALUES;

        ok = read_chunk(volume, slice * volume->next_slice + done, (size_t)chunk,
                        (char *)values + (size_t)done * value_size, error);
    }
    volume->next_slice += slice_count;
    if (ok && slice_count > 0 && volume->next_slice == volume->size[2])
        ok = volume_stream_check_end(volume->layout->stream, error);
    if (!ok) error_prefix(error, "%s", volume_stream_path(volume->layout->stream));
    return ok;
}
