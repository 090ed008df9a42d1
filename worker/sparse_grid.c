#include "worker/sparse_grid.h"

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

// Towards minus infinity.
static int brick_of(int voxel)
{
    return (voxel - (voxel & (SPARSE_BRICK_SIDE - 1))) / SPARSE_BRICK_SIDE;
}

float sparse_grid_at(const struct sparse_grid *grid, const int voxel[3])
{
    size_t brick = 0, within = 0;

    for (int axis = 2; axis >= 0; --axis) {
        int64_t at = (int64_t)brick_of(voxel[axis]) - grid->brick_min[axis];

        if (at < 0 || at >= grid->brick_count[axis]) return grid->background;
        brick = brick * (size_t)grid->brick_count[axis] + (size_t)at;
        within = within * SPARSE_BRICK_SIDE + (size_t)(voxel[axis] & (SPARSE_BRICK_SIDE - 1));
    }
    if (grid->bricks[brick].leaf < 0) return grid->bricks[brick].value;
    return grid->leaves[(size_t)grid->bricks[brick].leaf * SPARSE_BRICK_VOXELS + within];
}
