// Converts rows of floats to halves, rounded to the nearest, ties to even. Values that are too large become infinite.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

void half_row_from_floats(uint16_t *halves, const float *values, size_t count);
