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

// Where a program finds its file if the command line names none. Borrowed; NULL: not set.
struct options_file_place {
    const char *name;        // "marchd.conf"
    const char *system_path; // read for the system's programs
    const char *config_home; // $XDG_CONFIG_HOME, counts if it is absolute
    const char *home;
};

// The path of the file, if it is there; NULL: none. Owned by the caller.
char *options_file_find(const struct options_file_place *place, bool is_system);
// Says that no setting has that key, and which of `names` (end in NULL) is near it. `program` has a --help.
void options_file_fail_key(const char *key, const char *const names[], const char *program, struct error *error);
// A mistake does not end the reading.
void options_file_read(const char *path, const struct options_file_handlers *handlers);
