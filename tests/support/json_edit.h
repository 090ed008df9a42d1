// Changes one value of a JSON text, so that a test can derive its document from a valid one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

// Paths are as in messages: `scene.media[0].sigma_s`; the empty path is the whole document. Results are owned by
// the caller. A text that is no JSON or a path whose parent is not there ends the program.

// Puts `value` (JSON; NULL removes) at `path`; a missing last member is appended.
char *json_edit_set(const char *text, const char *path, const char *value);
// Gives the member at `path` another key.
char *json_edit_rename(const char *text, const char *path, const char *key);
struct json_place {
    char *path;
    bool is_string;
};

// The places of all values below the document, `*count` of them.
struct json_place *json_edit_places(const char *text, size_t *count);
void json_edit_free_places(struct json_place *places, size_t count);
