// The files of a sequence, given as a pattern or one by one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;

// One file; its texts are owned.
struct sequence_file {
    char *path;    // absolute
    char *label;   // the frame's number, else the file's name
    int32_t frame; // -1 when the name tells none
};

// The zero value is empty.
struct sequence {
    struct sequence_file *files; // owned
    size_t count, capacity;
};

// Adds what `operand` names: "cloud/cloud.####.exr" every file there is with a frame number (by number), else the file itself.
// Nothing found is an error. `range` (NULL: all) keeps only those frames of a pattern.
bool sequence_add(struct sequence *sequence, const char *operand, const char *range, struct error *error);
void sequence_finish(struct sequence *sequence);
