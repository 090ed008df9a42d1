// The transfer function of sRGB: IEC 61966-2-1, 1999.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Returns the linear light of a stored value; both in [0, 1].
double srgb_decode(double value);
// Returns the byte that stores linear light; NaN is black.
unsigned char srgb_encode_byte(float linear);
