// Which job a picture was rendered from, as its file's header says. It tells, and proves nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct picture_version {
    char hash[HASH_TEXT_SIZE]; // marchd:sequenceHash, the hash of its job
    bool is_draft;             // marchd:draft
};

// Reads the attributes from the first bytes of an OpenEXR file (its technical introduction describes the layout). False
// when they are no such file's, or no job is named in them.
bool picture_version_parse(struct picture_version *version, const uint8_t *bytes, size_t size);
// Likewise from the file `name` in an open folder; false, too, when it is no ordinary file or cannot be read.
bool picture_version_read(struct picture_version *version, int folder, const char *name);
