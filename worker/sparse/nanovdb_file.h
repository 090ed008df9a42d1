// The container of a NanoVDB file: lists its grids and unpacks one of them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;

struct nanovdb_bytes {
    const void *bytes; // borrowed
    size_t size_bytes;
};

struct nanovdb_unpacked {
    size_t size_bytes;
    uint32_t type; // one of worker/sparse/nanovdb_leaf.h, as the container says
};

// Unpacks the grid of this name (NULL: the first grid of floats, quantised or not) to its layout in memory, aligned for
// any type. The caller owns it; NULL on failure. Only the container is checked: the grid's bytes may be anything.
void *nanovdb_file_unpack(const struct nanovdb_bytes *file, const char *name, struct nanovdb_unpacked *unpacked,
                          struct error *error);
