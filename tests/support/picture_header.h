// The header of an OpenEXR file with the attributes by which the daemon knows whose picture it is.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PICTURE_HEADER_SIZE = 512 };

// `hash` becomes marchd:sequenceHash, between other attributes; NULL: none. Returns the count of bytes written.
size_t picture_header_write(uint8_t bytes[static PICTURE_HEADER_SIZE], const char *hash, bool is_draft);
