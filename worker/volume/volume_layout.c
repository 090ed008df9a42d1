// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume_layout.h"

#include "core/base/error.h"
#include "worker/volume/volume_stream.h"

#include <inttypes.h>
#include <stdlib.h>

void volume_layout_finish(struct volume_layout *layout)
{
    volume_stream_close(layout->stream);
    free(layout->staging);
    *layout = (struct volume_layout){0};
}

bool volume_layout_set_size(struct volume_layout *layout, const char *field, const int64_t size[3], struct error *error)
{
    int64_t voxels = 1;

    for (int axis = 0; axis < 3; axis++) {
        if (size[axis] < 1) {
            error_set(error, "%s: expected at least 1 voxel along %c, got %" PRId64, field, "ijk"[axis], size[axis]);
            return false;
        }
        if (size[axis] > VOLUME_VOXEL_LIMIT / voxels) {
            error_set(error, "%s: expected fewer than 2^31 voxels, got %" PRId64 " x %" PRId64 " x %" PRId64, field,
                      size[0], size[1], size[2]);
            return false;
        }
        voxels *= size[axis];
        layout->size[axis] = (int)size[axis];
    }
    return true;
}

int64_t volume_layout_voxels(const struct volume_layout *layout)
{
    return (int64_t)layout->size[0] * layout->size[1] * layout->size[2];
}

int64_t volume_layout_bytes(const struct volume_layout *layout)
{
    return volume_layout_voxels(layout) * (int64_t)volume_stored_size(layout->stored);
}

bool volume_layout_check_length(const struct volume_layout *layout, struct error *error)
{
    int64_t left = volume_stream_left(layout->stream);

    if (left < 0 || left == volume_layout_bytes(layout)) return true;
    error_set(error, "expected %d x %d x %d voxels of %s, %" PRId64 " bytes, got %" PRId64 " bytes", layout->size[0],
              layout->size[1], layout->size[2], volume_stored_name(layout->stored), volume_layout_bytes(layout), left);
    return false;
}
