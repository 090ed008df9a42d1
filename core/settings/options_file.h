// The configuration file: one setting `key = value` per line; blank lines and lines that begin with `#` are ignored.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

struct options_file_handlers {
    // Called for each setting in order; false with `error` set: a mistake.
    bool (*on_setting)(void *user, const char *key, const char *value, struct error *error);
    // Called for each mistake, which begins with file and line.
    void (*on_mistake)(void *user, const char *mistake);
    void *user;
};

// A mistake does not end the reading.
void options_file_read(const char *path, const struct options_file_handlers *handlers);
