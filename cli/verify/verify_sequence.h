// What a sequence of files is as a whole: complete, of one job and size, and how exact.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct frame_range;
struct verify_list;

struct verify_sequence {
    char *pattern;            // owned; "cloud.####.exr"
    size_t first, file_count; // its files in the list
    size_t wrong_count;
    char *frames;  // owned; that are there, as "0-9,12-20x2"; empty: its files have no numbers
    char *missing; // owned; likewise; empty: none is
    int64_t missing_count;
    size_t worst; // the file with the largest error, by index in the list; SIZE_MAX: none has an error
};

// What is expected beside what the files themselves say.
struct verify_expected {
    const struct frame_range
        *range;          // borrowed; NULL: from the first frame there is to the last, in the steps they have in common
    const char *pattern; // borrowed; NULL: as the files are named
    bool is_job;         // each file was held to a job: to compare them with one another adds nothing
};

// Of `file_count` files of the list from `first` on, sorted by frame, may be 0 where a range is expected. Blames files
// that differ from most of the others in size or job, repeat a frame, or whose name says another frame than the header.
void verify_sequence_judge(struct verify_sequence *sequence, struct verify_list *list, size_t first, size_t file_count,
                           const struct verify_expected *expected);
void verify_sequence_finish(struct verify_sequence *sequence);
