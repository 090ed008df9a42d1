// Pictures that could not be made lately: asking again at once would only take another worker's time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/error.h"
#include "core/base/hash.h"
#include "web/pictures/picture_status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PICTURE_FAULT_COUNT = 64, PICTURE_FAULT_MS = 30000 };

// The zero value is empty.
struct picture_faults {
    struct picture_fault {
        char key[HASH_TEXT_SIZE];
        enum picture_status status;
        struct error error;
        int64_t until_ms; // 0: empty
    } faults[PICTURE_FAULT_COUNT];
    size_t next;
};

// Remembers faults of the file; those of the machine may be over in a moment.
void picture_faults_note(struct picture_faults *faults, const char *key, enum picture_status status,
                         const struct error *error, int64_t now_ms);
// NULL: none is remembered.
const struct picture_fault *picture_faults_find(const struct picture_faults *faults, const char *key, int64_t now_ms);
