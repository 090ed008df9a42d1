// Converts rows of pixels to halves, rounded to the nearest, ties to even. Values that are too large become infinite.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

enum { HALF_ROW_PLANES = 4 }; // channels of a pixel

// Converts `count` pixels, whose channels are neighbours, and takes them apart: planes[i] gets channel i, unless it is
// NULL.
void half_row_split(uint16_t *const planes[static HALF_ROW_PLANES], const float *pixels, size_t count);
