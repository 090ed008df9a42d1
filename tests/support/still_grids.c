#include "tests/support/still_grids.h"

#include "core/alloc.h"
#include "core/error.h"
#include "core/job.h"
#include "worker/scene_inputs.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static double stored_at(const void *voxels, enum volume_type type, size_t i)
{
    switch (type) {
    case VOLUME_UINT8:
        return ((const uint8_t *)voxels)[i];
    case VOLUME_UINT16:
        return ((const uint16_t *)voxels)[i];
    case VOLUME_INT16:
        return ((const int16_t *)voxels)[i];
    case VOLUME_FLOAT32:
        break;
    }
    return (double)((const float *)voxels)[i];
}

static float *read_values(const struct scene_input *input)
{
    struct error error = {{0}};
    struct volume *volume;
    size_t count;
    float *values;
    void *voxels;

    if (!scene_input_open_volume(input, &volume, &error)) fail_msg("%s", error.message);
    count = (size_t)volume->size[0] * (size_t)volume->size[1] * (size_t)volume->size[2];
    voxels = xcalloc(count, volume_type_size(volume->type));
    values = xcalloc(count, sizeof *values);
    if (!volume_read(volume, volume->size[2], voxels, &error)) fail_msg("%s", error.message);
    for (size_t i = 0; i < count; ++i)
        values[i] = (float)(volume->slope * stored_at(voxels, volume->type, i) + volume->intercept);
    free(voxels);
    volume_close(volume);
    return values;
}

void still_grids_read(struct still_inputs *inputs, const struct job *job, int32_t frame)
{
    struct error error = {{0}};
    struct scene_inputs files;

    *inputs = (struct still_inputs){0};
    if (!scene_inputs_open(&files, job, frame, NULL, NULL, &error)) fail_msg("%s", error.message);
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i) {
        const struct scene_input *input = &files.media[i];
        struct still_grid *grid = &inputs->grids[i];

        if (!input->source) continue;
        grid->values = read_values(input);
        memcpy(grid->size, input->header.size, sizeof grid->size);
        memcpy(grid->index_to_world, input->header.index_to_world, sizeof grid->index_to_world);
    }
    scene_inputs_finish(&files);
}

void still_grids_finish(struct still_inputs *inputs)
{
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i)
        free((float *)inputs->grids[i].values);
    *inputs = (struct still_inputs){0};
}
