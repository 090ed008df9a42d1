// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/srgb_table.h"

#include "worker/picture/srgb.h"

#include <math.h>
#include <stddef.h>

static float float_of(uint32_t bits)
{
    float value;

    memcpy(&value, &bits, sizeof value);
    return value;
}

// Halves the range of bits, whose order is that of positive floats.
static float find_least(unsigned byte)
{
    uint32_t low = 0, high = 0x3f800000; // 0 and 1

    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;

        if (srgb_encode_byte(float_of(middle)) >= byte)
            high = middle;
        else
            low = middle;
    }
    return float_of(high);
}

void srgb_table_init(struct srgb_table *table)
{
    for (size_t i = 0; i < sizeof table->least; i++)
        table->least[i] = srgb_encode_byte(float_of((uint32_t)i << SRGB_TABLE_DROPPED_BITS));
    table->from[0] = 0.0f;
    for (unsigned byte = 1; byte <= 255; byte++)
        table->from[byte] = find_least(byte);
    table->from[256] = NAN; // which nothing reaches
}
