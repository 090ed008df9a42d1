// Frames of two jobs whose files have the same name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct frame_range;
struct frame_set;
struct output_path;

// Frame `first` of one pattern has the name of frame `other_first` of another; the next pair is `step` and `other_step`
// further on. There are `count` pairs, all of frame numbers.
struct frame_twins {
    int64_t first, step, other_first, other_step, count;
};

enum { FRAME_TWINS_LIMIT = 7 }; // one for each length of a frame's number

// All pairs of frame numbers for which both patterns give the same name, whatever their folders are. Returns how many
// structs they take.
size_t frame_twins_list(const struct output_path *path, const struct output_path *other,
                        struct frame_twins twins[static FRAME_TWINS_LIMIT]);
// Whether one of the pairs is in both ranges; `*frame` is its frame in `range`. In closed form for ranges of few spans.
// Else it takes a few nanoseconds a frame of `other`, and `marks`, which the caller keeps from one call to the next and
// frees, is filled with the frames of `range` once; it is empty at first.
bool frame_twins_find(const struct frame_twins *twins, size_t count, const struct frame_range *range,
                      struct frame_set *marks, const struct frame_range *other, int32_t *frame);
