// The file of `march render --preview`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct error;

// Checks that a file .png can be written there: one can be made in its folder, and what has its name is a file.
// Returns the absolute path, owned by the caller; NULL if not.
char *preview_path_check(const char *path, struct error *error);
