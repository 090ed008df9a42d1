// Says whether a text is strict JSON, before a more forgiving parser reads it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;

// RFC 8259 in UTF-8, one value and nothing after it, within the limits of json_read.h. The message begins with
// "line L, column C" (columns count characters from 1).
bool json_scan(const char *text, size_t length, struct error *error);
