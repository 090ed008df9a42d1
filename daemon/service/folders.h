// Folders that must be there before anything else: made with their parents.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

#include <sys/types.h>

struct error;

// Parents get 0755, the folder itself `mode`; what is there stays as it is. `path` is absolute.
bool folders_make(const char *path, mode_t mode, struct error *error);
