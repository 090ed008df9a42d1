// Opens an output root, and job's folders below it, by descriptors of the folder whose marker was checked.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct output_path;

enum { OUTPUT_ROOT_AWAY = -2 };

// An O_PATH descriptor of the folder at `root`, whose marker has that `id` (core/job/root_marker.h). What is opened
// below the descriptor is in this very folder, whatever happens to the path meanwhile. NULL for `id`: any folder.
// OUTPUT_ROOT_AWAY, with `error` set, when the folder or its marker cannot be opened, or is another one; errno tells a
// shortage of the program (error_is_shortage) from these.
int output_root_open(const char *root, const char *id, struct error *error);

// As output_path_open_folder, below output_root_open: -1 when the root is there and the folder cannot be opened (errno
// is ENOENT when it is missing), OUTPUT_ROOT_AWAY when the root is not there.
int output_root_open_folder(const struct output_path *path, const char *root, const char *id, bool create,
                            struct error *error);

// Whether the folder of the descriptor is still the one at `root`: a disk that is unmounted while its files are open
// takes them with it.
bool output_root_is_at(int root_fd, const char *root);
