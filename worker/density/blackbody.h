// The table of black bodies, for shaders/emission/blackbody.glsl.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

enum { BLACKBODY_TABLE_SIZE = 1024 };

// Entry i is for 1/kelvin = i / (BLACKBODY_TABLE_SIZE - 1) / 400: linear Rec. 709 divided by the luminance, not
// clipped, and log2(luminance / kelvin), the luminance being 1 at 1500 K.
void blackbody_fill_table(float table[static BLACKBODY_TABLE_SIZE][4]);
