// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/nanovdb_leaf.h"

#include <string.h>

// Museth, NanoVDB: A GPU-Friendly and Portable VDB Data Structure, SIGGRAPH Talks 2021; NanoVDB.h, LeafFnBase.
enum {
    FLAGS = 15,    // a byte; its upper three bits are the logarithm of the bits of a code, for FPN
    MINIMUM = 80,  // a float
    QUANTUM = 84,  // a float: what a code of 1 adds
    TABLE = 96,    // of values or codes
    LOG_LIMIT = 5, // codes of 1, 2, 4, 8 or 16 bits
    LEAST_CODES = NANOVDB_LEAF_VOXELS / 8
};

bool nanovdb_leaf_has_floats(uint32_t type)
{
    return type == NANOVDB_FLOAT || (type >= NANOVDB_FP4 && type <= NANOVDB_FPN);
}

static unsigned bits_log(uint32_t type, const unsigned char *leaf)
{
    return type == NANOVDB_FPN ? leaf[FLAGS] >> 5 : 2 + type - NANOVDB_FP4;
}

uint64_t nanovdb_leaf_least_bytes(uint32_t type)
{
    if (type == NANOVDB_FLOAT) return TABLE + NANOVDB_LEAF_VOXELS * sizeof(float);
    return TABLE + (type == NANOVDB_FPN ? LEAST_CODES : (uint64_t)LEAST_CODES << bits_log(type, NULL));
}

uint64_t nanovdb_leaf_bytes(uint32_t type, const unsigned char *leaf)
{
    unsigned log = type == NANOVDB_FPN ? bits_log(type, leaf) : 0;

    if (type != NANOVDB_FPN) return nanovdb_leaf_least_bytes(type);
    return log < LOG_LIMIT ? TABLE + ((uint64_t)LEAST_CODES << log) : 0;
}

// Codes are packed from the lowest bit of each byte on.
static unsigned read_code(const unsigned char *codes, unsigned log, unsigned n)
{
    unsigned bits = 1U << log;

    if (bits == 16) return codes[2 * n] | (unsigned)codes[2 * n + 1] << 8;
    return codes[n * bits / 8] >> n * bits % 8 & ((1U << bits) - 1);
}

void nanovdb_leaf_read(uint32_t type, const unsigned char *leaf, float values[static NANOVDB_LEAF_VOXELS])
{
    float minimum, quantum;

    if (type == NANOVDB_FLOAT) {
        memcpy(values, leaf + TABLE, NANOVDB_LEAF_VOXELS * sizeof values[0]);
        return;
    }
    memcpy(&minimum, leaf + MINIMUM, sizeof minimum);
    memcpy(&quantum, leaf + QUANTUM, sizeof quantum);
    for (unsigned n = 0; n < NANOVDB_LEAF_VOXELS; ++n)
        values[n] = (float)read_code(leaf + TABLE, bits_log(type, leaf), n) * quantum + minimum;
}
