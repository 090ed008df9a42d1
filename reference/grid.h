// Values on a lattice of voxels in the world, and their course along a ray.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/box.h"
#include "reference/vec3.h"

#include <stdbool.h>

struct grid {
    const float *values; // borrowed; i fastest, then j, then k
    int size[3];
    double world_to_index[12]; // row-major 3x4; voxel (i, j, k) has its centre at those numbers
    bool is_nearest;           // else trilinear
    double margin; // how far the box reaches beyond the outer centres, in voxels; values there are the outermost
};

struct grid_params {
    const float *values;
    int size[3];
    double index_to_world[12]; // row-major 3x4, invertible
    bool is_nearest;
    bool
        is_padded; // the outermost voxels are what lies around: the box ends at their centres, else half a voxel beyond
};

void grid_init(struct grid *grid, const struct grid_params *params);
bool grid_contains(const struct grid *grid, struct vec3 position);
// The value at a position in the grid's box; false: it lies outside.
bool grid_find(const struct grid *grid, struct vec3 position, double *value);
double grid_value(const struct grid *grid, struct vec3 position); // outside the box: the value at its nearest face

// The least and the greatest value in the part of the grid's box that lies in `box`; false: nothing lies there.
bool grid_range(const struct grid *grid, const struct box *box, double *low, double *high);
// The box along the world's axes about the grid's own.
void grid_extent(const struct grid *grid, struct box *box);

// A stretch of a ray within one cell. The value is a cubic of s, which is 0 at its begin and 1 at its end.
struct grid_stretch {
    double begin, end; // m along the ray
    double low, high;  // bounds of the values
    double cubic[4];
};

// Walks from cell to cell: between centres when values are interpolated, else from voxel to voxel.
struct grid_walk {
    const struct grid *grid;
    double origin[3], direction[3]; // of the ray, in voxels
    double at, far;                 // m along the ray
};

void grid_walk_init(struct grid_walk *walk, const struct grid *grid, const struct ray *ray, double near, double far);
bool grid_walk_next(struct grid_walk *walk, struct grid_stretch *stretch); // false at the end
