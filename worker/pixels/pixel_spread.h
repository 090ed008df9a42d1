// Values half way between the points of a lattice.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/pixels/pixel_calm.h"

#include <stdbool.h>

// A lattice of 4 floats a point, row by row, and the one of half its stride that is made of it. The finer one has at
// most 2 columns - 1 and 2 rows - 1 points, and at least one less.
struct pixel_spread {
    const float *values; // borrowed
    int columns, rows;
    int finer_columns;
    float scale[4];      // the weights of the four values in `doubt`
    float *cubic, *bend; // owned scratch, a row of the lattice each
};

void pixel_spread_init(struct pixel_spread *spread, const float *values, int columns, int rows, int finer_columns);
void pixel_spread_finish(struct pixel_spread *spread);

// Writes those points of a row of the finer lattice that lie in a run of cells (pixel_calm.h): points of the lattice as
// they are, the others by the cubic through the four points around along each axis, within the range of these (G.
// Deslauriers and S. Dubuc, Symmetric iterative interpolation processes, Constructive Approximation 5, 1989). Beyond
// the lattice's edge the quadratic of the last three points is followed. `doubt` grows to the largest weighted bend, an
// eighth of the larger of the two second differences of these points: a straight line is off by so much where both are
// equal. Their sum would hide a step between flat sides, and what alternates from point to point. Between rows, the
// bend along the columns is found in columns of the lattice. NULL: it is not wanted.
void pixel_spread_row(const struct pixel_spread *spread, int row, struct pixel_run run, float *finer, float *doubt);
// The same by linear interpolation.
void pixel_spread_row_linear(const struct pixel_spread *spread, int row, struct pixel_run run, float *finer);
