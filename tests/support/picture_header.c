// SPDX-License-Identifier: Apache-2.0
#include "tests/support/picture_header.h"

#include <string.h>

static size_t put(uint8_t *bytes, const void *from, size_t size)
{
    memcpy(bytes, from, size);
    return size;
}

// Words are little-endian in the file and on every machine that runs marchd.
static size_t put_attribute(uint8_t *bytes, const char *name, const char *type, const void *value, uint32_t size)
{
    size_t length = put(bytes, name, strlen(name) + 1);

    length += put(bytes + length, type, strlen(type) + 1);
    length += put(bytes + length, &size, 4);
    return length + put(bytes + length, value, size);
}

size_t picture_header_write(uint8_t bytes[static PICTURE_HEADER_SIZE], const char *hash, bool is_draft)
{
    static const uint8_t preamble[] = {0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0};
    uint32_t one = 1;
    size_t length = put(bytes, preamble, sizeof preamble);

    length += put_attribute(bytes + length, "compression", "compression", "\3", 1);
    if (hash) length += put_attribute(bytes + length, "marchd:sequenceHash", "string", hash, (uint32_t)strlen(hash));
    if (is_draft) length += put_attribute(bytes + length, "marchd:draft", "int", &one, 4);
    length += put_attribute(bytes + length, "marchd:name", "string", "ash", 3);
    bytes[length++] = '\0';
    return length;
}
