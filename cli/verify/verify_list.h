// The files of a folder that are verified, and what is known about each.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "core/job/job_beyond.h"
#include "core/wire/frame_accuracy.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct frame_range;
struct output_path;

struct verify_file {
    char *name;                       // owned; in the folder
    int32_t frame;                    // from its name; -1: it has no number
    size_t digits_start, digit_count; // of that number in the name; 0: unknown or none
    size_t sequence;                  // the number of its sequence in the folder
    char *wrong;                      // owned; its defects; NULL: none
    bool is_known;                    // its header could be read; the members below are from it
    int32_t header_frame;
    int width_px, height_px;
    char picture_hash[HASH_TEXT_SIZE];  // empty: none
    char sequence_hash[HASH_TEXT_SIZE]; // likewise
    double tolerance;                   // 0: none
    bool is_draft;                      // it promises no accuracy
    struct frame_accuracy accuracy;
    struct job_beyond beyond;
};

// The zero value is empty.
struct verify_list {
    char *folder;              // owned; absolute
    struct verify_file *files; // owned
    size_t count, capacity;
    size_t part_count; // part files, which are being written
};

// Reads the names of a folder's EXR files, unsorted, without subfolders. False when the folder cannot be read.
bool verify_list_read(struct verify_list *list, const char *folder, struct error *error);
// Keeps only files whose names have a frame of the range, and sets their frames.
void verify_list_keep(struct verify_list *list, const struct output_path *path, const struct frame_range *range);
void verify_list_finish(struct verify_list *list);

// Adds to the defects of a file.
__attribute__((format(printf, 2, 3))) void verify_file_blame(struct verify_file *file, const char *format, ...);
