// A transfer function as running integrals: extinction and source of a linear segment are a difference of two.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"

#include <stddef.h>

enum {
    TRANSFER_TABLE_CELLS = 1024, // between the first point's value and the last's
    // One more cell on each side, in which the function is constant, continues it outside.
    TRANSFER_TABLE_SIZE = TRANSFER_TABLE_CELLS + 3
};

// Node i is for the value first + (i - 1) (last - first) / TRANSFER_TABLE_CELLS. It holds the integral from node 0 to
// there, in cells, of rgb -ln(1 - a) and, last, of -ln(1 - a): source and extinction per unit distance.
void transfer_table_fill(const struct scene_transfer_point *points, size_t count, float table[TRANSFER_TABLE_SIZE][4]);
