// Makes the folders that the daemon needs at its start, with their parents.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

#include <sys/types.h>

struct error;

// Missing parents get mode 0755, the folder itself `mode`; folders that exist stay as they are. `path` is absolute.
bool folders_make(const char *path, mode_t mode, struct error *error);
