#include "tests/support/load_grid.h"

#include "core/alloc.h"
#include "core/error.h"
#include "core/file.h"
#include "core/input_path.h"
#include "core/job.h"
#include "reference/still.h"
#include "worker/sparse_grid.h"
#include "worker/volume.h"
#include "worker/volume_nanovdb.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static double stored_value(const struct volume *volume, const void *stored, size_t i)
{
    switch (volume->type) {
    case VOLUME_UINT8:
        return ((const uint8_t *)stored)[i];
    case VOLUME_UINT16:
        return ((const uint16_t *)stored)[i];
    case VOLUME_INT16:
        return ((const int16_t *)stored)[i];
    case VOLUME_FLOAT32:
        break;
    }
    return ((const float *)stored)[i];
}

static void load_volume(struct still_grid *grid, const struct scene_grid *source, const char *path)
{
    struct volume_source volume_source = {.path = path, .raw = source->raw};
    struct error error = {{0}};
    struct volume *volume;
    size_t count;
    float *values;
    void *stored;

    memcpy(volume_source.spacing, source->spacing, sizeof volume_source.spacing);
    if (!volume_open(&volume, &volume_source, &error)) fail_msg("%s", error.message);
    count = (size_t)volume->size[0] * (size_t)volume->size[1] * (size_t)volume->size[2];
    stored = xmalloc(count * volume_type_size(volume->type));
    values = xmalloc(count * sizeof values[0]);
    if (!volume_read(volume, volume->size[2], stored, &error)) fail_msg("%s", error.message);
    for (size_t i = 0; i < count; i++)
        values[i] = (float)(volume->slope * stored_value(volume, stored, i) + volume->intercept);
    grid->values = values;
    memcpy(grid->size, volume->size, sizeof grid->size);
    memcpy(grid->index_to_world, volume->index_to_world, sizeof grid->index_to_world);
    free(stored);
    volume_close(volume);
}

// Makes the active voxels' box dense, grown by the one voxel over which they fade.
static void unpack(struct still_grid *grid, const struct sparse_grid *sparse)
{
    const double *m = sparse->index_to_world;
    float *values;
    size_t count = 1;

    for (int a = 0; a < 3; a++) {
        grid->size[a] = sparse->voxel_max[a] - sparse->voxel_min[a] + 3;
        count *= (size_t)grid->size[a];
    }
    values = xmalloc(count * sizeof values[0]);
    for (size_t i = 0; i < count; i++) {
        const int voxel[3] = {sparse->voxel_min[0] - 1 + (int)(i % (size_t)grid->size[0]),
                              sparse->voxel_min[1] - 1 + (int)(i / (size_t)grid->size[0] % (size_t)grid->size[1]),
                              sparse->voxel_min[2] - 1 + (int)(i / (size_t)grid->size[0] / (size_t)grid->size[1])};

        values[i] = sparse_grid_at(sparse, voxel);
    }
    grid->values = values;
    grid->is_padded = true;
    memcpy(grid->index_to_world, m, sizeof grid->index_to_world);
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++)
            grid->index_to_world[4 * a + 3] += m[4 * a + b] * (sparse->voxel_min[b] - 1);
    }
}

// Voxels of other sides in the same directions, from the same origin.
static void stretch(struct sparse_grid *sparse, const double spacing[3])
{
    double *m = sparse->index_to_world;

    for (int a = 0; a < 3; a++) {
        double length = sqrt(m[a] * m[a] + m[4 + a] * m[4 + a] + m[8 + a] * m[8 + a]);

        for (int row = 0; spacing[a] > 0 && row < 3; row++)
            m[4 * row + a] *= spacing[a] / length;
    }
}

static void load_nanovdb(struct still_grid *grid, const struct scene_grid *source, const char *path, const char *name)
{
    enum { LIMIT = 1 << 30 };
    struct error error = {{0}};
    struct sparse_grid *sparse;
    struct nanovdb_bytes file;
    char *text;

    if (!file_read_text(path, LIMIT, &text, &file.size_bytes, &error)) fail_msg("%s: %s", path, error.message);
    file.bytes = text;
    sparse = volume_nanovdb_decode(&file, name, &error);
    if (!sparse) {
        fail_msg("%s: %s", path, error.message);
        return;
    }
    stretch(sparse, source->spacing);
    unpack(grid, sparse);
    sparse_grid_destroy(sparse);
    free(text);
}

void load_grid_inputs(struct still_inputs *inputs, const struct job *job, int32_t frame)
{
    *inputs = (struct still_inputs){0};
    for (size_t m = 0; m < job->scene.medium_count; m++) {
        const struct scene_medium *medium = &job->scene.media[m];
        char *path;

        if (medium->density.kind != SCENE_DENSITY_GRID) continue;
        path = input_path_format(medium->density.grid.file, frame);
        if (input_path_has_ending(path, ".nvdb")) {
            load_nanovdb(&inputs->grids[m], &medium->density.grid, path, medium->density.grid.grid_name);
            if (medium->blackbody.grid_name) {
                load_nanovdb(&inputs->temperatures[m], &medium->density.grid, path, medium->blackbody.grid_name);
            }
        } else {
            load_volume(&inputs->grids[m], &medium->density.grid, path);
        }
        free(path);
    }
}

void load_grid_finish(struct still_inputs *inputs)
{
    for (size_t m = 0; m < SCENE_MEDIUM_LIMIT; m++) {
        free((void *)inputs->grids[m].values);
        free((void *)inputs->temperatures[m].values);
    }
    *inputs = (struct still_inputs){0};
}
