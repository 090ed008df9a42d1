// Where a frame shows voxels that a lattice of pixels may miss: bricks of grids with density.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"

#include <stdint.h>

enum {
    VOXEL_GUARD_EVER = 4,        // px
    VOXEL_GUARD_IN_THE_CLEAR = 2 // a byte
};

struct grid_bricks;
struct job;
struct scene_inputs;

// Cells of the first level of a lattice: those whose pixels (x, y) have x / size_px and y / size_px in common.
struct voxel_guards {
    int size_px, columns, rows;
    // Owned; row by row: points of levels down to this stride are traced in the cell. 0: none for its own sake. NULL:
    // in no cell.
    uint8_t *strides;
};

struct voxel_guards_params {
    const struct job *job;
    const struct scene_inputs *inputs;                    // the frame's
    const struct grid_bricks *bricks[SCENE_MEDIUM_LIMIT]; // of grids that are not sparse; NULL: unknown
    int32_t frame;
};

// Finds the rectangles around the pictures of all bricks with density, at the moments of scene_guards_find_moments.
// In these each voxel that camera rays meet directly is met by one at least: a voxel shows around its centre a disk of
// its shortest edge's radius, which has a point of each lattice whose stride is no longer than 1.4 times that edge; the
// edge itself is taken, and 0.7 of it where a voxel is no larger than its cell. From there on pixels are traced because
// they differ. Points of strides below VOXEL_GUARD_EVER are only wanted between points that met no extinction: a voxel
// so small may be missed before or behind other density.
void voxel_guards_init(struct voxel_guards *guards, const struct voxel_guards_params *params);
void voxel_guards_finish(struct voxel_guards *guards); // accepts empty ones
// Writes 1 for those points of a lattice, `columns` x `rows` of them, that the guards want, or VOXEL_GUARD_IN_THE_CLEAR
// for those that they want between points without extinction; never over a 1.
void voxel_guards_mark(const struct voxel_guards *guards, int stride, int columns, int rows, uint8_t *forced);
