// The files of a sequence, given as a folder, as a pattern or one by one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;

// One file; its texts are owned.
struct sequence_file {
    char *path;    // absolute
    char *label;   // the frame's number; without one, the file's name
    int32_t frame; // -1 when the name has none
};

// The zero value is empty.
struct sequence {
    struct sequence_file *files; // owned
    size_t count, capacity;
};

// Adds the files of `operand`: for a pattern such as "cloud/cloud.####.exr" all existing files, in the order of their
// frame numbers; for a folder those of the one sequence that is in it; else the file itself. Finding none is an error.
// `range` (NULL: all) selects frames of a pattern or a folder.
bool sequence_add(struct sequence *sequence, const char *operand, const char *range, struct error *error);
void sequence_finish(struct sequence *sequence);
