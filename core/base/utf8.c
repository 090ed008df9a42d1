// SPDX-License-Identifier: Apache-2.0
#include "core/base/utf8.h"

#include <stdbool.h>

static bool is_continuation(unsigned char byte)
{
    return (byte & 0xc0) == 0x80;
}

size_t utf8_character_length(const char *bytes, size_t length)
{
    const unsigned char *b = (const unsigned char *)bytes;

    if (length == 0) return 0;
    if (b[0] < 0x80) return 1;
    if (b[0] < 0xc2 || b[0] > 0xf4 || length < 2 || !is_continuation(b[1])) return 0;
    if (b[0] < 0xe0) return 2;
    if (length < 3 || !is_continuation(b[2])) return 0;
    if (b[0] < 0xf0) {
        bool overlong = b[0] == 0xe0 && b[1] < 0xa0;
        bool surrogate = b[0] == 0xed && b[1] > 0x9f;

        return overlong || surrogate ? 0 : 3;
    }
    if (length < 4 || !is_continuation(b[3])) return 0;
    if ((b[0] == 0xf0 && b[1] < 0x90) || (b[0] == 0xf4 && b[1] > 0x8f)) return 0;
    return 4;
}

size_t utf8_prefix_length(const char *bytes, size_t length, size_t limit)
{
    if (length <= limit) return length;
    while (limit > 0 && is_continuation((unsigned char)bytes[limit]))
        limit--;
    return limit;
}
