// The values of a NanoVDB leaf: floats, or codes of a few bits between the leaf's least and greatest value.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum { NANOVDB_LEAF_VOXELS = 512 };

// Types of grids whose values are floats, as files number them.
enum {
    NANOVDB_FLOAT = 1,
    NANOVDB_FP4 = 13,
    NANOVDB_FP8 = 14,
    NANOVDB_FP16 = 15,
    NANOVDB_FPN = 16 // 1 to 16 bits, another number in each leaf
};

bool nanovdb_leaf_has_floats(uint32_t type); // whether it is one of these
// The least bytes that a leaf takes. All leaves take so many, except with NANOVDB_FPN.
uint64_t nanovdb_leaf_least_bytes(uint32_t type);
// The bytes that the leaf takes, by its first nanovdb_leaf_least_bytes; 0: its header names no number of bits.
uint64_t nanovdb_leaf_bytes(uint32_t type, const unsigned char *leaf);
// Reads the values of a whole leaf, k fastest. They may not be finite.
void nanovdb_leaf_read(uint32_t type, const unsigned char *leaf, float values[static NANOVDB_LEAF_VOXELS]);
