// Which file a frame reads: "smoke/smoke.####.nvdb" stands for one file a frame.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;

enum { INPUT_PATH_LIMIT = 4000 }; // bytes

// Only the name behind the last slash may hold the frame's number: a `#` in a folder's name is just that. A name has at
// most one run of up to 9 `#`; a path has 1 to INPUT_PATH_LIMIT bytes and no control bytes.
bool input_path_check(const char *path, struct error *error);
bool input_path_is_sequence(const char *path);
// The number is padded with zeros to the run's length. Owned by the caller.
char *input_path_format(const char *path, int32_t frame);
// True of an absolute path each of whose names is one: not "", "." or "..".
bool input_path_is_plain(const char *path);
// Upper and lower case are alike; an ending alone is no name.
bool input_path_has_ending(const char *path, const char *ending);
