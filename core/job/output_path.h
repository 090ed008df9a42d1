// The path of a frame's file, "cloud/cloud.####.exr", below an output root that no path may leave.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;

enum {
    OUTPUT_NAME_SIZE = 256, // a file name with its NUL
    OUTPUT_FARM_DIGITS = 8  // of a farm's id in part files' names
};

// The zero value is empty. `folder` is relative to the output root ("" for the root itself), the file name is
// prefix + number padded to `pad` digits + suffix.
struct output_path {
    char *folder; // owned
    char *prefix; // owned
    char *suffix; // owned
    int pad;
};

// Refuses "..", "." and empty components, a number sign or %0Nd in a folder, none or two of them in the name, control
// bytes, names too long for a part file, and a name that does not end in ".exr". Refuses absolute paths too: callers
// that allow one below the root make it relative first (output_path_below).
bool output_path_parse(struct output_path *path, const char *pattern, struct error *error);
void output_path_finish(struct output_path *path);
// "/srv/out/a/b.#.exr" below root "/srv/out" is "a/b.#.exr", borrowed from `pattern`. A relative path is returned
// unchanged. An absolute path outside the root is an error.
const char *output_path_below(const char *pattern, const char *root, struct error *error);

void output_path_format_name(const struct output_path *path, int32_t frame, char name[static OUTPUT_NAME_SIZE]);
// An attempt at a frame. Farms that share a root have the same numbers of jobs, but not the same id.
struct output_part {
    const char *farm; // its id, of which the first OUTPUT_FARM_DIGITS count; NULL or "": of no farm
    int64_t job;
    int64_t epoch; // of at most 10 digits
    int32_t frame;
    int attempt;
};

// The name of the file that an attempt writes: NAME.<farm>.<job>.<epoch>.<attempt>.part, without <farm> for no farm.
void output_path_format_part(const struct output_path *path, const struct output_part *part,
                             char name[static OUTPUT_NAME_SIZE]);
// Whether `name` is the name of such a file of the path: of the farm, or of none, as older versions wrote. `farm` is
// borrowed.
bool output_path_read_part(const struct output_path *path, const char *farm, const char *name,
                           struct output_part *part);
// The frame whose file `name` is, or -1.
int32_t output_path_frame_of(const struct output_path *path, const char *name);
// True when two frame numbers could give both the same file name; the caller must then compare frame by frame.
bool output_path_may_collide(const struct output_path *a, const struct output_path *b);

// Opens the folder below `root`, component by component, following no link (openat2 with RESOLVE_BENEATH |
// RESOLVE_NO_SYMLINKS; openat with O_NOFOLLOW where the kernel lacks it). Makes missing folders if `create`. Returns a
// descriptor, or -1 with the component named in `error`, and errno set. `root` itself may be reached through links.
int output_path_open_folder(const struct output_path *path, const char *root, bool create, struct error *error);
// Likewise below an open folder, which may be an O_PATH descriptor; `root` is its name in messages. errno is ENOENT
// when a component is missing.
int output_path_open_below(const struct output_path *path, int root_fd, const char *root, bool create,
                           struct error *error);
