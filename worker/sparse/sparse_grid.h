// A grid of floats that is mostly empty: bricks of 8^3 voxels on a lattice in index space.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

enum {
    SPARSE_BRICK_SIDE = 8,
    SPARSE_BRICK_VOXELS = 512,
    SPARSE_LATTICE_LIMIT = 2048 // bricks along one axis: a side that every GL 4.5 has for a 3D texture
};

struct sparse_brick {
    int32_t leaf; // the leaf with its voxels; -1: all are `value`
    float value;
};

struct sparse_grid {
    double index_to_world[12];      // row-major 3x4, from (i, j, k, 1) to the voxel's centre in metres
    int voxel_min[3], voxel_max[3]; // the box of the active voxels, inclusive
    int brick_min[3];               // the lattice's first brick; brick b has the voxels 8 b to 8 b + 7
    int brick_count[3];             // the lattice covers the voxels' box and one voxel more on each side
    struct sparse_brick *bricks;    // owned; i fastest
    float *leaves;                  // owned; SPARSE_BRICK_VOXELS each, i fastest
    size_t leaf_count;
    float background; // of every voxel outside the lattice
};

void sparse_grid_destroy(struct sparse_grid *grid); // NULL is accepted
size_t sparse_grid_brick_total(const struct sparse_grid *grid);
// Returns the values of brick (i, j, k), which may be outside of the lattice, or NULL when all of them are `*value`.
const float *sparse_grid_brick(const struct sparse_grid *grid, const int brick[3], float *value);
// Returns the value of voxel (i, j, k), which may be outside of the lattice.
float sparse_grid_at(const struct sparse_grid *grid, const int voxel[3]);
