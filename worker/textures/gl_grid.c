// SPDX-License-Identifier: Apache-2.0
#include "worker/textures/gl_grid.h"

#include "core/base/error.h"
#include "worker/gl/gl_functions.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

enum { SLAB_BYTES = 1024 * 1024 };

struct texel {
    GLenum internal, format, component;
};

static struct texel texel_of(enum volume_type type)
{
    switch (type) {
    case VOLUME_UINT8:
        return (struct texel){GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE};
    case VOLUME_UINT16:
        return (struct texel){GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT};
    case VOLUME_INT16:
        return (struct texel){GL_R16I, GL_RED_INTEGER, GL_SHORT};
    case VOLUME_FLOAT32:
        break;
    }
    return (struct texel){GL_R32F, GL_RED, GL_FLOAT};
}

static bool check_size(const struct gl_grid_params *params, struct error *error)
{
    const int *size = params->volume->size;
    GLint side_limit = 0, slice_limit = 0;

    params->gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &side_limit);
    params->gl->GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &slice_limit);
    if (size[0] > side_limit || size[1] > side_limit || size[2] > slice_limit) {
        error_set(error, "%s: GL here takes volumes of at most %d x %d x %d voxels, got %d x %d x %d", params->path,
                  side_limit, side_limit, slice_limit, size[0], size[1], size[2]);
        return false;
    }
    return true;
}

static bool make_texture(struct gl_grid *grid, const char *path, const int size[3], struct error *error)
{
    const struct gl_functions *gl = grid->gl;

    gl->CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &grid->voxels);
    gl->TextureStorage3D(grid->voxels, 1, texel_of(grid->type).internal, size[0], size[1], size[2]);
    if (gl->GetError() == GL_OUT_OF_MEMORY) {
        error_set(error, "%s: GL here has no room for %d x %d x %d voxels in one texture (%.2f GiB)", path, size[0],
                  size[1], size[2], (double)grid->size_bytes / (1 << 30));
        return false;
    }
    gl->TextureParameteri(grid->voxels, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TextureParameteri(grid->voxels, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->TextureParameteri(grid->voxels, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TextureParameteri(grid->voxels, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return true;
}

static bool stream_slabs(struct gl_grid *grid, const struct gl_grid_params *params, void *slab, int slab_slices,
                         struct error *error)
{
    const struct gl_functions *gl = grid->gl;
    struct volume *volume = params->volume;
    const int *size = volume->size;

    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    for (int first = 0; first < size[2]; first += slab_slices) {
        int count = size[2] - first < slab_slices ? size[2] - first : slab_slices;

        if (!volume_read(volume, count, slab, error)) return false;
        grid_bricks_add(&grid->bricks, grid->type, slab, first, count);
        gl->TextureSubImage3D(grid->voxels, 0, 0, 0, first, size[0], size[1], count, texel_of(grid->type).format,
                              texel_of(grid->type).component, slab);
        if (params->on_progress && !params->on_progress(params->user)) {
            error_set(error, "the frame was stopped");
            return false;
        }
    }
    return true;
}

bool gl_grid_init(struct gl_grid *grid, const struct gl_grid_params *params, struct error *error)
{
    const struct volume *volume = params->volume;
    const int *size = volume->size;
    size_t slice_bytes = (size_t)size[0] * (size_t)size[1] * volume_type_size(volume->type);
    int slab_slices = slice_bytes < SLAB_BYTES ? (int)(SLAB_BYTES / slice_bytes) : 1;
    void *slab = NULL;
    bool ok = false;

    *grid =
        (struct gl_grid){.gl = params->gl, .type = volume->type, .size_bytes = slice_bytes * (size_t)volume->size[2]};
    if (slab_slices > size[2]) slab_slices = size[2];
    if (!check_size(params, error)) goto out;
    slab = malloc(slice_bytes * (size_t)slab_slices);
    if (!slab) {
        error_set(error, "%s: out of memory", params->path);
        goto out;
    }
    ok = grid_bricks_init(&grid->bricks, size, error) && make_texture(grid, params->path, size, error) &&
         stream_slabs(grid, params, slab, slab_slices, error);
out:
    free(slab);
    if (!ok) gl_grid_finish(grid);
    return ok;
}

void gl_grid_finish(struct gl_grid *grid)
{
    if (grid->voxels) grid->gl->DeleteTextures(1, &grid->voxels);
    grid_bricks_finish(&grid->bricks);
    *grid = (struct gl_grid){0};
}

// Makes a texture of one texel a brick.
static unsigned make_bricks(const struct gl_grid *grid, GLenum internal, GLenum component, const void *texels)
{
    const struct gl_functions *gl = grid->gl;
    const int *count = grid->bricks.count;
    unsigned texture = 0;

    gl->CreateTextures(GL_TEXTURE_3D, 1, &texture);
    gl->TextureStorage3D(texture, 1, internal, count[0], count[1], count[2]);
    gl->TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl->TextureSubImage3D(texture, 0, 0, 0, 0, count[0], count[1], count[2], GL_RED, component, texels);
    return texture;
}

static size_t count_bricks(const struct gl_grid *grid)
{
    const int *count = grid->bricks.count;

    return (size_t)count[0] * (size_t)count[1] * (size_t)count[2];
}

unsigned gl_grid_create_distances(const struct gl_grid *grid, double slope, double intercept,
                                  grid_bricks_is_empty *is_empty, const void *user)
{
    unsigned char *distances = malloc(count_bricks(grid));
    unsigned texture;

    if (!distances) return 0;
    grid_bricks_find_distances(&grid->bricks, slope, intercept, is_empty, user, distances);
    texture = make_bricks(grid, GL_R8, GL_UNSIGNED_BYTE, distances);
    free(distances);
    return texture;
}

struct most {
    gl_grid_find_most *find;
    const void *user;
};

static bool is_nothing(double min, double max, const void *user)
{
    const struct most *most = user;

    return most->find(min, max, most->user) <= 0;
}

unsigned gl_grid_create_majorants(const struct gl_grid *grid, double slope, double intercept,
                                  gl_grid_find_most *find_most, const void *user)
{
    size_t count = count_bricks(grid);
    float *most = malloc(count * sizeof *most);
    unsigned char *distances = malloc(count);
    unsigned texture = 0;

    if (!most || !distances) goto out;
    grid_bricks_find_distances(&grid->bricks, slope, intercept, is_nothing, &(struct most){find_most, user}, distances);
    for (size_t i = 0; i < count; ++i) {
        double a = slope * (double)grid->bricks.bounds[i].min + intercept;
        double b = slope * (double)grid->bricks.bounds[i].max + intercept;

        most[i] = distances[i] > 0 ? -(float)distances[i] : (float)find_most(fmin(a, b), fmax(a, b), user);
    }
    texture = make_bricks(grid, GL_R32F, GL_FLOAT, most);
out:
    free(distances);
    free(most);
    return texture;
}
