// Reads a density from a file of voxels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct scene_grid;
struct scene_reader;

// `reader` stands at the density; `grid` is empty. On failure the caller still calls scene_finish.
bool grid_from_json(struct scene_grid *grid, const struct scene_reader *reader);
