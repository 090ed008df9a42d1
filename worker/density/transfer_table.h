// A transfer function as running integrals: what a segment of linear values extinguishes and sends out is a difference of two.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"

#include <stddef.h>

enum {
    TRANSFER_TABLE_CELLS = 1024, // between the first point's value and the last's
    // Before and behind these is one cell each in which the function holds, so that its line goes on outside.
    TRANSFER_TABLE_SIZE = TRANSFER_TABLE_CELLS + 3
};

// Node i belongs to the value first + (i - 1) (last - first) / TRANSFER_TABLE_CELLS. It has the integral from node 0 up to there,
// in cells, of rgb -ln(1 - a) and, last, of -ln(1 - a): per unit distance, what is sent out and what is extinguished.
void transfer_table_fill(const struct scene_transfer_point *points, size_t count, float table[TRANSFER_TABLE_SIZE][4]);
