// Writes NanoVDB files byte by byte, for tests to read and to damage.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct nanovdb_tile {
    int origin[3]; // a multiple of the side
    int side;      // 8, 128 or 4096
    float value;
    bool is_active;
};

struct nanovdb_params {
    const char *name;
    double map[12]; // index to world, 3x4 row-major
    // The active voxels' box, inclusive; leaves cover it. min[0] > max[0]: none.
    int min[3], max[3];
    float (*value)(const int voxel[3]); // of an active voxel
    float background;                   // of voxels outside of leaves and tiles
    const struct nanovdb_tile *tiles;
    size_t tile_count;
    bool is_zip, is_blosc;
    // Of a value: 4, 8 or 16; 0: values are floats; NANOVDB_MAKER_VARIABLE: 1, 2, 4, 8 and 16, another in each leaf.
    int bits;
};

enum { NANOVDB_MAKER_VARIABLE = -1 };

// Owned by the caller.
struct nanovdb_made {
    unsigned char *bytes;
    size_t size_bytes;
    // Offsets of parts in an uncompressed file, and of parts in a node.
    size_t metadata, grid, tree, root, root_tiles, uppers, lowers, leaves;
    size_t lower_bytes, upper_table, lower_table, leaf_values;
    size_t leaf_count;
};

void nanovdb_make(struct nanovdb_made *made, const struct nanovdb_params *params);
