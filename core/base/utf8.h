// Tells well-formed UTF-8 from other bytes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

// The length in bytes (1 to 4) of the character at the start of `bytes`, or 0 when it is not well formed. Overlong
// forms, surrogates and values over U+10FFFF are not well formed.
size_t utf8_character_length(const char *bytes, size_t length);
// The length of the longest prefix of at most `limit` bytes that ends between characters.
size_t utf8_prefix_length(const char *bytes, size_t length, size_t limit);
