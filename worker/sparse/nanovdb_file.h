// The frame of a NanoVDB file: which grids it says to hold, and one of them unpacked.
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

// The grid's bytes as they lie in memory, owned by the caller, aligned for any type; NULL on failure. `name` NULL: the first
// grid of floats. Nothing but the frame is checked: the grid itself may be anything.
void *nanovdb_file_unpack(const struct nanovdb_bytes *file, const char *name, size_t *size_bytes, struct error *error);
