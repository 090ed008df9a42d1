// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/srgb.h"

#include <math.h>

double srgb_decode(double value)
{
    return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
}

unsigned char srgb_encode_byte(float linear)
{
    float value = linear;

    if (!(value > 0)) return 0;
    value = value <= 0.0031308f ? value * 12.92f : 1.055f * powf(value, 1.0f / 2.4f) - 0.055f;
    return value >= 1.0f ? 255 : (unsigned char)lroundf(value * 255.0f);
}
