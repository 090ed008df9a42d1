// Reads a sparse grid of floats from a NanoVDB file, which may hold anything.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/sparse/nanovdb_file.h"

struct error;
struct sparse_grid;

// The grid of this name, NULL: the first of floats; NULL on failure. A value that is not finite is refused with its voxel.
// The caller destroys it.
struct sparse_grid *volume_nanovdb_decode(const struct nanovdb_bytes *file, const char *name, struct error *error);
