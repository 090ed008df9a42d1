// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/truth_files.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/scene/input_path.h"
#include "worker/picture/image.h"
#include "worker/scene/texture_image.h"
#include "worker/sparse/sparse_file.h"
#include "worker/sparse/sparse_grid.h"
#include "worker/volume/volume.h"
#include "worker/volume/volume_memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void free_values(const float *values)
{
    free((void *)(uintptr_t)values);
}

static void drop_file(struct truth_file *file)
{
    free(file->path);
    *file = (struct truth_file){0};
}

static void drop_medium(struct truth_files *files, size_t medium)
{
    free_values(files->inputs.grids[medium].values);
    free_values(files->inputs.temperatures[medium].values);
    files->inputs.grids[medium] = files->inputs.temperatures[medium] = (struct still_grid){0};
    drop_file(&files->media[medium]);
}

// An image that is held, a texture or a dome.
struct held {
    struct still_texture *texture;
    struct truth_file *file;
};

static struct held held_texture(struct truth_files *files, size_t object)
{
    return (struct held){&files->inputs.textures[object], &files->textures[object]};
}

static struct held held_dome(struct truth_files *files)
{
    return (struct held){&files->inputs.dome, &files->dome};
}

static void drop_image(struct held held)
{
    free_values(held.texture->rgb);
    *held.texture = (struct still_texture){0};
    drop_file(held.file);
}

static int64_t held_bytes(const struct truth_files *files)
{
    int64_t sum = files->dome.size_bytes;

    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; i++)
        sum += files->media[i].size_bytes;
    for (size_t i = 0; i < SCENE_OBJECT_LIMIT; i++)
        sum += files->textures[i].size_bytes;
    return sum;
}

// Allocates `count` floats and adds their size to `file`. NULL on failure.
static float *reserve(const struct truth_files *files, struct truth_file *file, int64_t count, struct error *error)
{
    int64_t size_bytes = count * (int64_t)sizeof(float);
    float *values = NULL;

    if (volume_memory_check(held_bytes(files) + size_bytes, volume_memory_limit() / 2, error)) {
        values = malloc((size_t)size_bytes);
        if (values)
            file->size_bytes += size_bytes;
        else
            error_set(error, "out of memory");
    }
    if (!values) error_prefix(error, "the reference holds it as one block of floats, with what it held before");
    return values;
}

static float stored_value(const struct volume *volume, const void *stored, size_t i)
{
    double value = 0.0;

    switch (volume->type) {
    case VOLUME_UINT8:
        value = ((const uint8_t *)stored)[i];
        break;
    case VOLUME_UINT16:
        value = ((const uint16_t *)stored)[i];
        break;
    case VOLUME_INT16:
        value = ((const int16_t *)stored)[i];
        break;
    case VOLUME_FLOAT32:
        value = ((const float *)stored)[i];
        break;
    }
    return (float)(volume->slope * value + volume->intercept);
}

static bool read_slices(struct volume *volume, float *values, struct error *error)
{
    size_t count = (size_t)volume->size[0] * (size_t)volume->size[1];
    void *stored = malloc(count * volume_type_size(volume->type));
    bool ok = stored != NULL;

    if (!ok) error_set(error, "out of memory");
    for (int k = 0; ok && k < volume->size[2]; k++) {
        ok = volume_read(volume, 1, stored, error);
        for (size_t i = 0; ok && i < count; i++)
            values[(size_t)k * count + i] = stored_value(volume, stored, i);
    }
    free(stored);
    return ok;
}

static bool load_volume(struct truth_files *files, size_t medium, const struct scene_grid *source, struct error *error)
{
    struct volume_source volume_source = {.path = files->media[medium].path, .raw = source->raw};
    struct still_grid *grid = &files->inputs.grids[medium];
    struct volume *volume;
    float *values;
    bool ok = false;

    memcpy(volume_source.spacing, source->spacing, sizeof volume_source.spacing);
    if (!volume_open(&volume, &volume_source, error)) return false;
    values = reserve(files, &files->media[medium], (int64_t)volume->size[0] * volume->size[1] * volume->size[2], error);
    grid->values = values;
    memcpy(grid->size, volume->size, sizeof grid->size);
    memcpy(grid->index_to_world, volume->index_to_world, sizeof grid->index_to_world);
    if (values)
        ok = read_slices(volume, values, error);
    else
        error_prefix(error, "%s", volume_source.path);
    volume_close(volume);
    return ok;
}

// Gives voxels other side lengths; directions and origin stay.
static void stretch(struct sparse_grid *sparse, const double spacing[static 3])
{
    double *m = sparse->index_to_world;

    for (int a = 0; a < 3; a++) {
        double length = sqrt(m[a] * m[a] + m[4 + a] * m[4 + a] + m[8 + a] * m[8 + a]);

        for (int row = 0; spacing[a] > 0.0 && row < 3; row++)
            m[4 * row + a] *= spacing[a] / length;
    }
}

static void unpack_voxels(const struct sparse_grid *sparse, const int size[static 3], float *values)
{
    int voxel[3];

    for (int k = 0; k < size[2]; k++) {
        for (int j = 0; j < size[1]; j++) {
            for (int i = 0; i < size[0]; i++) {
                voxel[0] = sparse->voxel_min[0] - 1 + i;
                voxel[1] = sparse->voxel_min[1] - 1 + j;
                voxel[2] = sparse->voxel_min[2] - 1 + k;
                *values++ = sparse_grid_at(sparse, voxel);
            }
        }
    }
}

// Unpacks the box of the active voxels into a dense grid, with a border of one voxel over which they fade.
static bool unpack(struct truth_files *files, struct truth_file *file, struct still_grid *grid,
                   const struct sparse_grid *sparse, struct error *error)
{
    const double *m = sparse->index_to_world;
    int64_t count = 1;
    float *values;

    for (int a = 0; a < 3; a++) {
        grid->size[a] = sparse->voxel_max[a] - sparse->voxel_min[a] + 3;
        count *= grid->size[a];
    }
    values = reserve(files, file, count, error);
    if (!values) return false;
    unpack_voxels(sparse, grid->size, values);
    grid->values = values;
    grid->is_padded = true;
    memcpy(grid->index_to_world, m, sizeof grid->index_to_world);
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++)
            grid->index_to_world[4 * a + 3] += m[4 * a + b] * (sparse->voxel_min[b] - 1);
    }
    return true;
}

static bool decode(struct truth_files *files, struct truth_file *file, struct still_grid *grid,
                   const struct sparse_file *sparse_file, const char *name, const double spacing[static 3],
                   struct error *error)
{
    struct sparse_grid *sparse = sparse_file_decode(sparse_file, name, error);
    bool ok;

    if (!sparse) return false;
    stretch(sparse, spacing);
    ok = unpack(files, file, grid, sparse, error);
    sparse_grid_destroy(sparse);
    return ok;
}

static bool load_sparse(struct truth_files *files, size_t m, const struct scene_medium *medium, struct error *error)
{
    const struct scene_grid *source = &medium->density.grid;
    struct truth_file *file = &files->media[m];
    struct sparse_file sparse_file;
    bool ok = sparse_file_load(&sparse_file, file->path, NULL, error);

    if (ok) {
        ok = decode(files, file, &files->inputs.grids[m], &sparse_file, source->grid_name, source->spacing, error);
        if (ok && medium->blackbody.grid_name)
            ok = decode(files, file, &files->inputs.temperatures[m], &sparse_file, medium->blackbody.grid_name,
                        source->spacing, error);
        sparse_file_finish(&sparse_file);
    }
    if (!ok) error_prefix(error, "%s", file->path);
    return ok;
}

// True when `file` holds the present contents of `path`; then frees the path.
static bool is_held(const struct truth_file *file, char *path)
{
    struct file_version version;
    bool is_same = file->path && strcmp(file->path, path) == 0 && file_version_find(path, &version, NULL) &&
                   file_version_is_same(&version, &file->version) && file_version_is_settled(&version);

    if (is_same) free(path);
    return is_same;
}

static bool load_medium(struct truth_files *files, size_t m, const struct scene_medium *medium, int32_t frame,
                        struct error *error)
{
    const struct scene_grid *source = &medium->density.grid;
    char *path = input_path_format(source->file, frame);

    if (is_held(&files->media[m], path)) return true;
    drop_medium(files, m);
    files->media[m].path = path;
    if (!file_version_find(path, &files->media[m].version, error)) return false;
    if (scene_grid_is_sparse(source)) return load_sparse(files, m, medium, error);
    return load_volume(files, m, source, error);
}

static bool load_image(struct truth_files *files, struct held held, const struct scene_texture *source,
                       struct error *error)
{
    struct truth_file *file = held.file;
    char *path = xstrdup(source->file);
    struct image image;
    float *rgb;

    if (is_held(file, path)) return true;
    drop_image(held);
    file->path = path;
    if (!file_version_find(path, &file->version, error)) return false;
    if (!texture_image_load(&image, source, error)) return false;
    rgb = reserve(files, file, 3 * (int64_t)image.width_px * image.height_px, error);
    for (size_t i = 0; rgb && i < 3 * (size_t)image.width_px * (size_t)image.height_px; i++)
        rgb[i] = image.rgba[i / 3 * 4 + i % 3];
    if (rgb) *held.texture = (struct still_texture){rgb, image.width_px, image.height_px};
    image_finish(&image);
    return rgb != NULL;
}

bool truth_files_load(struct truth_files *files, const struct job *job, int32_t frame, struct error *error)
{
    const struct scene *scene = &job->scene;
    bool ok = true;

    for (size_t i = 0; ok && i < scene->medium_count; i++)
        if (scene->media[i].density.kind == SCENE_DENSITY_GRID)
            ok = load_medium(files, i, &scene->media[i], frame, error);
    for (size_t i = 0; ok && i < scene->object_count; i++)
        if (scene->objects[i].material.texture.file)
            ok = load_image(files, held_texture(files, i), &scene->objects[i].material.texture, error);
    for (size_t i = 0; ok && i < scene->light_count; i++)
        if (scene->lights[i].dome.image.file)
            ok = load_image(files, held_dome(files), &scene->lights[i].dome.image, error);
    if (!ok) truth_files_finish(files);
    return ok;
}

void truth_files_finish(struct truth_files *files)
{
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; i++)
        drop_medium(files, i);
    for (size_t i = 0; i < SCENE_OBJECT_LIMIT; i++)
        drop_image(held_texture(files, i));
    drop_image(held_dome(files));
}
