// Checks that a text is strict JSON before a more lenient parser reads it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;

enum {
    JSON_DEPTH_LIMIT = 32,
    JSON_VALUE_LIMIT = 1000 * 1000, // values in a text, each some 100 bytes of memory
    JSON_NUMBER_SIZE = 64           // a number's characters and a NUL
};

// RFC 8259 in UTF-8, one value and nothing after it, within these limits. The message begins with
// "line L, column C" (columns count characters from 1).
bool json_scan(const char *text, size_t length, struct error *error);
