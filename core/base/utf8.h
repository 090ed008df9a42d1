// Tells well-formed UTF-8 from other bytes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

// The length in bytes (1 to 4) of the character at the start of `bytes`, or 0 when it is not well formed. Overlong
// forms, surrogates and values over U+10FFFF are not well formed.
size_t utf8_character_length(const char *bytes, size_t length);
// The length of the longest prefix of at most `limit` bytes that ends between characters.
size_t utf8_prefix_length(const char *bytes, size_t length, size_t limit);
// The first character of `text` that people cannot see, or that changes the order in which they read the others:
// control characters, U+0080 to U+009F among them, soft hyphens, marks of direction, joiners and other characters
// without a width, ends of lines and paragraphs, tags. NULL: there is none. Bytes that are not well formed end the
// search.
const char *utf8_find_hidden(const char *text);
// The code point of the well-formed character at the start of `text`, which is not empty.
uint32_t utf8_code_point(const char *text);
