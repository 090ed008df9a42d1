// Lines of a picture along which pixels are traced, whatever is beside them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

// A straight line, or a point. On each level of a lattice the points up to `reach` steps away are traced.
struct pixel_guard {
    double from[2], to[2]; // px; the centre of the top left pixel is (0, 0)
    int reach;             // at least 1
};

// Sets the bytes of those points of a lattice, `columns` x `rows` of them, that the guard wants.
void pixel_guard_mark(const struct pixel_guard *guard, int stride, int columns, int rows, uint8_t *forced);
