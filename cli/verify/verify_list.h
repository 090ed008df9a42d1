// Files that are verified: what a folder has of them, and what is known of each.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "core/wire/frame_accuracy.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct frame_range;
struct output_path;

struct verify_file {
    char *name;                       // owned; in the folder
    int32_t frame;                    // by its name; -1: it has no number
    size_t digits_start, digit_count; // of that number in the name; none: not looked for, or it has none
    size_t sequence;                  // which of the sequences in the folder it belongs to
    char *wrong;                      // owned; NULL: nothing is
    bool is_known;                    // its header could be read and says what follows
    int32_t header_frame;
    int width_px, height_px;
    char picture_hash[HASH_TEXT_SIZE];  // empty: it says none
    char sequence_hash[HASH_TEXT_SIZE]; // likewise
    double tolerance;                   // 0: it states none
    struct frame_accuracy accuracy;
};

// The zero value is empty.
struct verify_list {
    char *folder;              // owned; absolute
    struct verify_file *files; // owned
    size_t count, capacity;
    size_t part_count; // files that are being written
};

// All EXR files of a folder, in no order, and none of its folders'; false when it cannot be read.
bool verify_list_read(struct verify_list *list, const char *folder, struct error *error);
// Keeps the files that hold a frame of the range, by their names, and notes their frames.
void verify_list_keep(struct verify_list *list, const struct output_path *path, const struct frame_range *range);
void verify_list_finish(struct verify_list *list);

// Adds to what is wrong with a file.
__attribute__((format(printf, 2, 3))) void verify_file_blame(struct verify_file *file, const char *format, ...);
