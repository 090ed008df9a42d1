// The configuration file: one setting `key = value` per line; blank lines and lines that begin with `#` are ignored.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

// Called for each setting; false, with `error` set, ends the reading.
typedef bool options_file_on_setting(void *user, const char *key, const char *value, struct error *error);

// Calls `on_setting` for the settings of `path` in order. Errors, also of the callback, begin with file and line.
bool options_file_read(const char *path, options_file_on_setting *on_setting, void *user, struct error *error);
