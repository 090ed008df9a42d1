// Reads a sparse grid of floats from the bytes of a NanoVDB file, which may be anything.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/sparse/nanovdb_file.h"

struct error;
struct sparse_grid;

// Returns the grid of this name (NULL: the first of floats, quantised or not); NULL on failure. A value that is not
// finite is an error that names its voxel. The caller destroys the grid.
struct sparse_grid *volume_nanovdb_decode(const struct nanovdb_bytes *file, const char *name, struct error *error);
