// Converts rows of pixels to halves, rounded to the nearest, ties to even. Values that are too large become infinite.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

enum { HALF_ROW_PLANES = 4 }; // channels of a pixel

// Converts `count` pixels, whose channels are neighbours, and takes them apart: channel i is at halves + i * count.
void half_row_split(uint16_t *halves, const float *pixels, size_t count);
