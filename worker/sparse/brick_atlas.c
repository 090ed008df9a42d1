// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/brick_atlas.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "worker/sparse/sparse_grid.h"
#include "worker/volume/volume_memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    SIDE = BRICK_ATLAS_SIDE,
    SLOT_VOXELS = SIDE * SIDE * SIDE,
    LAYER_LIMIT = 2048 / SIDE,  // slots; every GL 4.5 has arrays of so many layers
    ACROSS_LIMIT = 16384 / SIDE // and textures that wide
};

void brick_atlas_destroy(struct brick_atlas *atlas)
{
    if (!atlas) return;
    for (int i = 0; i < BRICK_ATLAS_GRIDS; ++i)
        free(atlas->values[i]);
    free(atlas->index);
    free(atlas);
}

static void find_position(const int count[3], size_t brick, int position[3])
{
    position[0] = (int)(brick % (size_t)count[0]);
    position[1] = (int)(brick / (size_t)count[0] % (size_t)count[1]);
    position[2] = (int)(brick / (size_t)count[0] / (size_t)count[1]);
}

// The voxels that a slot copies from one brick: its own, or one beside it.
struct part {
    int source[3];          // the brick
    int first[3], count[3]; // voxels: the position in the slot, and how many of the source's first
};

// A slot has eight parts: the brick's voxels and those of the next bricks that interpolation uses. Bit `axis` of
// `number` says that the source is the next brick along that axis.
static struct part part_of(const int brick[3], int number)
{
    struct part part;

    for (int axis = 0; axis < 3; ++axis) {
        bool is_next = number >> axis & 1;

        part.source[axis] = brick[axis] + is_next;
        part.first[axis] = is_next ? SPARSE_BRICK_SIDE : 0;
        part.count[axis] = is_next ? 1 : SPARSE_BRICK_SIDE;
    }
    return part;
}

static void copy_part(const struct sparse_grid *grid, const struct part *part, float values[SLOT_VOXELS])
{
    float value;
    const float *leaf = sparse_grid_brick(grid, part->source, &value);

    for (int k = 0; k < part->count[2]; ++k)
        for (int j = 0; j < part->count[1]; ++j)
            for (int i = 0; i < part->count[0]; ++i)
                values[part->first[0] + i + SIDE * (part->first[1] + j + SIDE * (part->first[2] + k))] =
                    leaf ? leaf[i + SPARSE_BRICK_SIDE * (j + SPARSE_BRICK_SIDE * k)] : value;
}

static void copy_brick(const struct sparse_grid *grid, const int brick[3], float values[SLOT_VOXELS])
{
    for (int number = 0; number < 8; ++number) {
        struct part part = part_of(brick, number);

        copy_part(grid, &part, values);
    }
}

static void widen(struct grid_bound *bound, float value)
{
    bound->min = fminf(bound->min, value);
    bound->max = fmaxf(bound->max, value);
}

static void widen_by_part(struct grid_bound *bound, const struct sparse_grid *grid, const struct part *part)
{
    float value;
    const float *leaf = sparse_grid_brick(grid, part->source, &value);

    if (!leaf) {
        widen(bound, value);
        return;
    }
    for (int k = 0; k < part->count[2]; ++k)
        for (int j = 0; j < part->count[1]; ++j)
            for (int i = 0; i < part->count[0]; ++i)
                widen(bound, leaf[i + SPARSE_BRICK_SIDE * (j + SPARSE_BRICK_SIDE * k)]);
}

static struct grid_bound bound_of(const struct sparse_grid *grid, const int brick[3])
{
    struct grid_bound bound = {INFINITY, -INFINITY};

    for (int number = 0; number < 8; ++number) {
        struct part part = part_of(brick, number);

        widen_by_part(&bound, grid, &part);
    }
    return bound;
}

static bool is_not_above_zero(double min, double max, const void *user)
{
    return max <= 0;
}

// Stores each brick's distance to the nearest brick with density.
static bool find_reach(struct brick_atlas *atlas, const struct brick_atlas_params *params, struct error *error)
{
    const struct sparse_grid *density = params->density;
    grid_bricks_is_empty *is_empty = params->is_empty ? params->is_empty : is_not_above_zero;
    size_t total = sparse_grid_brick_total(density);
    struct grid_bricks bricks = {.bounds = malloc(total * sizeof *bricks.bounds)};
    unsigned char *distances = malloc(total);
    bool ok = bricks.bounds && distances;

    if (!ok) {
        error_set(error, "out of memory for %zu bricks", total);
        goto out;
    }
    memcpy(bricks.count, density->brick_count, sizeof bricks.count);
    atlas->bound = (struct grid_bound){INFINITY, -INFINITY};
    for (size_t n = 0; n < total; ++n) {
        int brick[3];

        find_position(density->brick_count, n, brick);
        for (int axis = 0; axis < 3; ++axis)
            brick[axis] += density->brick_min[axis];
        bricks.bounds[n] = bound_of(density, brick);
        widen(&atlas->bound, bricks.bounds[n].min);
        widen(&atlas->bound, bricks.bounds[n].max);
    }
    grid_bricks_find_distances(&bricks, 1, 0, is_empty, params->user, distances);
    for (size_t n = 0; n < total; ++n)
        atlas->index[n][3] = distances[n];
out:
    free(bricks.bounds);
    free(distances);
    return ok;
}

// Arranges the slots in about a cube.
static bool lay_out_slots(struct brick_atlas *atlas, size_t count, struct error *error)
{
    size_t layers = (size_t)ceil(cbrt((double)count)), across, down;

    if (layers > LAYER_LIMIT) layers = LAYER_LIMIT;
    across = (size_t)ceil(sqrt((double)count / (double)layers));
    down = (count + across * layers - 1) / (across * layers);
    layers = (count + across * down - 1) / (across * down);
    if (across > ACROSS_LIMIT) {
        error_set(error, "%zu bricks of 8^3 voxels with density are more than a texture holds", count);
        return false;
    }
    atlas->slots[0] = (int)across;
    atlas->slots[1] = (int)down;
    atlas->slots[2] = (int)layers;
    for (int axis = 0; axis < 3; ++axis)
        atlas->texels[axis] = SIDE * atlas->slots[axis];
    return true;
}

static void paste(const struct brick_atlas *atlas, float *texels, const uint16_t slot[3],
                  const float values[SLOT_VOXELS])
{
    size_t width = (size_t)atlas->texels[0], layer = width * (size_t)atlas->texels[1];

    for (size_t k = 0; k < SIDE; ++k)
        for (size_t j = 0; j < SIDE; ++j)
            memcpy(texels + SIDE * (size_t)slot[0] + width * (SIDE * (size_t)slot[1] + j) +
                       layer * (SIDE * (size_t)slot[2] + k),
                   values + SIDE * (j + SIDE * k), SIDE * sizeof *values);
}

// The values are in memory twice: here, and as textures, which may be in the machine's own memory.
static bool check_memory(const struct brick_atlas *atlas, const struct brick_atlas_params *params, struct error *error)
{
    int64_t texels = (int64_t)atlas->texels[0] * atlas->texels[1] * atlas->texels[2];
    int64_t limit = params->memory_bytes > 0 ? params->memory_bytes : volume_memory_limit();

    return volume_memory_check(2 * texels * (int64_t)sizeof(float) * (params->glow ? 2 : 1), limit, error);
}

static bool fill_slots(struct brick_atlas *atlas, const struct brick_atlas_params *params, struct error *error)
{
    int grid_count = params->glow ? 2 : 1;
    const struct sparse_grid *density = params->density, *grids[BRICK_ATLAS_GRIDS] = {density, params->glow};
    size_t texels = (size_t)atlas->texels[0] * (size_t)atlas->texels[1] * (size_t)atlas->texels[2];
    size_t total = sparse_grid_brick_total(density), used = 1;

    for (int i = 0; i < grid_count; ++i) {
        atlas->values[i] = calloc(texels, sizeof(float));
        atlas->size_bytes += texels * sizeof(float);
        if (!atlas->values[i]) {
            error_set(error, "out of memory for %zu texels", texels);
            return false;
        }
    }
    for (size_t n = 0; n < total; ++n) {
        int brick[3], slot[3];

        if (atlas->index[n][3] > 0) continue;
        find_position(density->brick_count, n, brick);
        find_position(atlas->slots, used++, slot);
        for (int axis = 0; axis < 3; ++axis) {
            brick[axis] += density->brick_min[axis];
            atlas->index[n][axis] = (uint16_t)slot[axis];
        }
        for (int i = 0; i < grid_count; ++i) {
            float values[SLOT_VOXELS];

            copy_brick(grids[i], brick, values);
            paste(atlas, atlas->values[i], atlas->index[n], values);
        }
    }
    return true;
}

static bool check_places(const struct sparse_grid *density, const struct sparse_grid *glow, struct error *error)
{
    double size = 0;

    for (int i = 0; i < 12; ++i)
        size = fmax(size, fabs(density->index_to_world[i]));
    for (int i = 0; i < 12; ++i)
        if (fabs(density->index_to_world[i] - glow->index_to_world[i]) > 1e-9 * size) {
            error_set(error, "the two grids' voxels lie in different positions; expected one map for both");
            return false;
        }
    return true;
}

struct brick_atlas *brick_atlas_create(const struct brick_atlas_params *params, struct error *error)
{
    const struct sparse_grid *density = params->density;
    struct brick_atlas *atlas;
    size_t total = sparse_grid_brick_total(density), count = 1;

    if (params->glow && !check_places(density, params->glow, error)) return NULL;
    atlas = xcalloc(1, sizeof *atlas);
    memcpy(atlas->brick_min, density->brick_min, sizeof atlas->brick_min);
    memcpy(atlas->brick_count, density->brick_count, sizeof atlas->brick_count);
    memcpy(atlas->voxel_min, density->voxel_min, sizeof atlas->voxel_min);
    memcpy(atlas->voxel_max, density->voxel_max, sizeof atlas->voxel_max);
    memcpy(atlas->index_to_world, density->index_to_world, sizeof atlas->index_to_world);
    atlas->index = calloc(total, sizeof *atlas->index);
    atlas->size_bytes = total * sizeof *atlas->index;
    if (!atlas->index) {
        error_set(error, "out of memory for %zu bricks", total);
        goto failed;
    }
    if (!find_reach(atlas, params, error)) goto failed;
    for (size_t n = 0; n < total; ++n)
        count += atlas->index[n][3] == 0;
    if (!lay_out_slots(atlas, count, error) || !check_memory(atlas, params, error) || !fill_slots(atlas, params, error))
        goto failed;
    return atlas;
failed:
    brick_atlas_destroy(atlas);
    return NULL;
}
