// Tells well-formed UTF-8 from other bytes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

// How many bytes the character at the start of `bytes` takes (1 to 4), or 0 when none of `length` bytes' start is well
// formed: overlong forms, surrogates and values over U+10FFFF are not.
size_t utf8_character_length(const char *bytes, size_t length);
// The largest prefix of at most `limit` bytes that cuts no character.
size_t utf8_prefix_length(const char *bytes, size_t length, size_t limit);
