// SPDX-License-Identifier: Apache-2.0
#include "core/base/utf8.h"

#include <stdbool.h>
#include <string.h>

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

uint32_t utf8_code_point(const char *text)
{
    const unsigned char *b = (const unsigned char *)text;

    if (b[0] < 0x80) return b[0];
    if (b[0] < 0xe0) return (uint32_t)(b[0] & 0x1f) << 6 | (b[1] & 0x3f);
    if (b[0] < 0xf0) return (uint32_t)(b[0] & 0x0f) << 12 | (uint32_t)(b[1] & 0x3f) << 6 | (b[2] & 0x3f);
    return (uint32_t)(b[0] & 0x07) << 18 | (uint32_t)(b[1] & 0x3f) << 12 | (uint32_t)(b[2] & 0x3f) << 6 | (b[3] & 0x3f);
}

// Unicode Standard, chapter 23, "Special Areas and Format Characters".
static bool is_hidden(uint32_t code)
{
    static const struct {
        uint32_t first, last;
    } hidden[] = {{0x00, 0x1f},     {0x7f, 0x9f},     {0xad, 0xad},      {0x61c, 0x61c},
                  {0x180e, 0x180e}, {0x200b, 0x200f}, {0x2028, 0x202e},  {0x2060, 0x206f},
                  {0xfeff, 0xfeff}, {0xfff9, 0xfffb}, {0xe0000, 0xe007f}};

    for (size_t i = 0; i < sizeof hidden / sizeof hidden[0]; i++)
        if (code >= hidden[i].first && code <= hidden[i].last) return true;
    return false;
}

const char *utf8_find_hidden(const char *text)
{
    size_t left = strlen(text), size;

    for (; (size = utf8_character_length(text, left)) > 0; text += size, left -= size)
        if (is_hidden(utf8_code_point(text))) return text;
    return NULL;
}
