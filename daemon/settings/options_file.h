// The daemon's configuration file: a setting a line, `key = value`, blank lines and lines that begin with `#` left out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

// Takes one setting; false with `error` set ends the reading.
typedef bool options_file_on_setting(void *user, const char *key, const char *value, struct error *error);

// Hands the settings of `path` to `on_setting` in their order. Errors, the callback's too, begin with file and line.
bool options_file_read(const char *path, options_file_on_setting *on_setting, void *user, struct error *error);
