// Where a frame's file goes: "cloud/cloud.####.exr" below a root that nothing may leave.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;

enum { OUTPUT_NAME_SIZE = 256 }; // a file name with its NUL

// The zero value is empty. `folder` is relative to the output root ("" for the root itself), the file name is
// prefix + number padded to `pad` digits + suffix.
struct output_path {
    char *folder; // owned
    char *prefix; // owned
    char *suffix; // owned
    int pad;
};

// Refuses "..", "." and empty components, a number sign or %0Nd in a folder, none or two of them in the name, control
// bytes, names too long for a part file, and a name that does not end in ".exr". An absolute path is refused: callers
// that allow one below the root make it relative first (output_path_below).
bool output_path_parse(struct output_path *path, const char *pattern, struct error *error);
void output_path_finish(struct output_path *path);
// "/srv/out/a/b.#.exr" below root "/srv/out" is "a/b.#.exr": borrowed from `pattern`. Relative ones are returned as they
// are. An absolute one outside the root is an error.
const char *output_path_below(const char *pattern, const char *root, struct error *error);

void output_path_format_name(const struct output_path *path, int32_t frame, char name[static OUTPUT_NAME_SIZE]);
// The name an attempt writes to: NAME.<job>.<epoch>.<attempt>.part.
void output_path_format_part(const struct output_path *path, int32_t frame, int64_t job, int64_t epoch, int attempt,
                             char name[static OUTPUT_NAME_SIZE]);
// The frame whose file `name` is, or -1.
int32_t output_path_frame_of(const struct output_path *path, const char *name);
// True when some frame number in both could name one file, so that the caller must compare frame by frame.
bool output_path_may_collide(const struct output_path *a, const struct output_path *b);

// Opens the folder below `root`, component by component, following no link (openat2 RESOLVE_BENEATH |
// RESOLVE_NO_SYMLINKS, where the kernel lacks it openat with O_NOFOLLOW); makes missing folders if `create`. Returns a
// descriptor, or -1 with the component named. `root` itself may be reached through links.
int output_path_open_folder(const struct output_path *path, const char *root, bool create, struct error *error);
