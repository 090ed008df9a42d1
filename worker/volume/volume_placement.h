// Builds and checks index_to_world, the row-major 3x4 matrix from voxel indices to positions in metres.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

// Sets axes i, j, k along x, y, z and the grid's middle at the origin.
void volume_placement_centered(double index_to_world[12], const int size[3], const double spacing[3]);
// Sets the same with cubic voxels and a longest side of 1 m, for files without a placement.
void volume_placement_unit(double index_to_world[12], const int size[3]);
// Gives the voxels the sides `spacing`; their directions and the grid's middle stay.
void volume_placement_respace(double index_to_world[12], const int size[3], const double spacing[3]);
// Checks that all is finite, no side has length 0, and the three directions span space.
bool volume_placement_check(const double index_to_world[12], struct error *error);
