// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/sparse_grid.h"

#include <stdlib.h>

void sparse_grid_destroy(struct sparse_grid *grid)
{
    if (!grid) return;
    free(grid->bricks);
    free(grid->leaves);
    free(grid);
}

size_t sparse_grid_brick_total(const struct sparse_grid *grid)
{
    return (size_t)grid->brick_count[0] * (size_t)grid->brick_count[1] * (size_t)grid->brick_count[2];
}

// Rounds towards minus infinity.
static int brick_of(int voxel)
{
    return (voxel - (voxel & (SPARSE_BRICK_SIDE - 1))) / SPARSE_BRICK_SIDE;
}

const float *sparse_grid_brick(const struct sparse_grid *grid, const int brick[3], float *value)
{
    const struct sparse_brick *found;
    size_t index = 0;

    for (int axis = 2; axis >= 0; --axis) {
        int64_t at = (int64_t)brick[axis] - grid->brick_min[axis];

        if (at < 0 || at >= grid->brick_count[axis]) {
            *value = grid->background;
            return NULL;
        }
        index = index * (size_t)grid->brick_count[axis] + (size_t)at;
    }
    found = &grid->bricks[index];
    *value = found->value;
    return found->leaf < 0 ? NULL : grid->leaves + (size_t)found->leaf * SPARSE_BRICK_VOXELS;
}

float sparse_grid_at(const struct sparse_grid *grid, const int voxel[3])
{
    int brick[3];
    size_t within = 0;
    const float *values;
    float value;

    for (int axis = 2; axis >= 0; --axis) {
        brick[axis] = brick_of(voxel[axis]);
        within = within * SPARSE_BRICK_SIDE + (size_t)(voxel[axis] & (SPARSE_BRICK_SIDE - 1));
    }
    values = sparse_grid_brick(grid, brick, &value);
    return values ? values[within] : value;
}
