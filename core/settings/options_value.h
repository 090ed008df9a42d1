// Values of options, read from text: counts, seconds, sizes, names.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/log.h"

#include <stdbool.h>
#include <stdint.h>

struct error;

// Each reads the value `text` of option --`name`. On failure the result is undefined and `error` says what was
// expected.
bool options_value_count(const char *name, const char *text, int max, int *count, struct error *error); // [1, max]
bool options_value_seconds(const char *name, const char *text, double min, int64_t *ms, struct error *error);
// "auto" is 0, "none" is -1.
bool options_value_workers(const char *text, int *count, struct error *error);
// At least 1, with a suffix K, M, G or T: powers of `kilo`. "none" is `none`.
bool options_value_limit(const char *name, const char *text, int64_t kilo, int64_t none, int64_t *limit,
                         struct error *error);
bool options_value_memory(const char *name, const char *text, int64_t *size_bytes, struct error *error); // "auto": 0
bool options_value_switch(const char *name, const char *text, bool *is_on, struct error *error);         // yes or no
// The name of a user or group; replaces an owned string.
bool options_value_name(const char *name, const char *text, bool may_be_empty, char **value, struct error *error);
bool options_value_backend(const char *text, char **backend, struct error *error); // replaces an owned string
bool options_value_level(const char *text, enum log_level *level, struct error *error);
// An absolute path without slashes at its end, owned by the caller; NULL on failure. Without `current_folder`, `text`
// has to be absolute.
char *options_value_path(const char *name, const char *text, const char *current_folder, struct error *error);
