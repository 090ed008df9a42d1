// Which frames of a sequence to render, written "1-100x2,140".
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;

enum {
    FRAME_NUMBER_LIMIT = 10 * 1000 * 1000, // a frame number is in [0, FRAME_NUMBER_LIMIT)
    FRAME_COUNT_LIMIT = 4 * 1000 * 1000    // frames of one range as written; one named twice counts twice
};

// `count` numbers: first, first + step, ...; step may be negative.
struct frame_span {
    int32_t first;
    int32_t step;
    int32_t count;
    int32_t before; // frames in the spans before this one
};

struct frame_position {
    int32_t frame;
    int32_t index; // in the range
};

// The zero value is an empty range.
struct frame_range {
    struct frame_span *spans; // owned; in the user's order, no frame twice
    size_t span_count;
    // Owned; ascending by frame, so that a range of many spans is searched fast. NULL when there are few spans.
    struct frame_position *positions;
};

// Reads `text` into `range`: comma-separated `7`, `1-10`, `10-1` (reverse), `1-10x3`; spaces may surround a part. A
// frame that is named twice keeps its first position. On failure `range` is empty and `error` says which part is wrong.
// `:` is refused with a hint.
bool frame_range_parse(struct frame_range *range, const char *text, struct error *error);
void frame_range_finish(struct frame_range *range); // accepts an empty range
int64_t frame_range_count(const struct frame_range *range);
int32_t frame_range_at(const struct frame_range *range, int64_t index);    // index in [0, count)
int64_t frame_range_index(const struct frame_range *range, int32_t frame); // -1 when the range lacks it
char *frame_range_format(const struct frame_range *range); // owned by the caller; parses back to the same
