// Where a volume's voxels lie: building and checking index_to_world, a row-major 3x4 matrix in metres.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

// Axes i, j, k along x, y, z; the grid's middle at the origin.
void volume_place_centered(double index_to_world[12], const int size[3], const double spacing[3]);
// The same with cubic voxels and a longest side of 1 m: for files that say nothing.
void volume_place_unit(double index_to_world[12], const int size[3]);
// Gives the voxels the sides `spacing`; their directions and the grid's middle stay.
void volume_place_respace(double index_to_world[12], const int size[3], const double spacing[3]);
// Finite, no side of length 0, and the three directions span space.
bool volume_place_check(const double index_to_world[12], struct error *error);
