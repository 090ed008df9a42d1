// Judges a sequence of files as a whole: complete, of one job and size, and how exact.
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
    size_t missed_count; // files that say that they are over their tolerance
    char *frames;        // owned; the frames found, as "0-9,12-20x2"; empty: the files have no numbers
    char *missing;       // owned; the frames missing; empty: none
    int64_t missing_count;
    size_t worst; // the file with the largest error, by index in the list; SIZE_MAX: none has an error
    // The file whose modelled orders of scattering leave out the largest part; SIZE_MAX: none says what they do.
    size_t most_beyond;
};

// Expectations beside those that the files themselves state.
struct verify_expected {
    const struct frame_range *range; // borrowed; NULL: from the first frame found to the last, in their common step
    const char *pattern;             // borrowed; NULL: from the names of the files
    bool is_job;                     // each file was compared with a job, so that they need not be with each other
};

// Judges `file_count` files of the list from `first` on, sorted by frame; the count may be 0 where a range is expected.
// Blames files that differ from most others in size or job, repeat a frame, or whose name and header differ in the
// frame.
void verify_sequence_judge(struct verify_sequence *sequence, struct verify_list *list, size_t first, size_t file_count,
                           const struct verify_expected *expected);
void verify_sequence_finish(struct verify_sequence *sequence);
