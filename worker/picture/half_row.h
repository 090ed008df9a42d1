// Floats as halves, many at once: rounded to the nearest, ties to even; what is too large becomes infinite.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

void half_row_from_floats(uint16_t *halves, const float *values, size_t count);
