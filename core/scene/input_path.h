// The path of a file that frames read; "smoke/smoke.####.nvdb" is a sequence with a file for each frame.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;

enum { INPUT_PATH_LIMIT = 4000 }; // bytes

// Checks a path: 1 to INPUT_PATH_LIMIT bytes, no control bytes, and at most one run of up to 9 `#` in the name behind
// the last slash. A `#` in a folder's name has no meaning.
bool input_path_check(const char *path, struct error *error);
bool input_path_is_sequence(const char *path);
// The path for a frame, its number padded with zeros to the run's length. Owned by the caller.
char *input_path_format(const char *path, int32_t frame);
// True of an absolute path without empty components, "." and "..".
bool input_path_is_plain(const char *path);
// Ignores case. A name that is only the ending does not count.
bool input_path_has_ending(const char *path, const char *ending);
