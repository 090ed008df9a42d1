// In which order a job's frames are rendered: some first, then the rest as they are written.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

enum { FRAME_ORDER_LIMIT = 8 };

// A stage of the order; a positive number n is every n-th frame, from the first on.
enum { FRAME_ORDER_FIRST = 0, FRAME_ORDER_LAST = -1, FRAME_ORDER_MIDDLE = -2 };

// The zero value is the order as written.
struct frame_order {
    int32_t stages[FRAME_ORDER_LIMIT]; // the rest follows the last one
    int count;
};

// Frames are named by their index in the range, of `count` frames, at least 1. The order has `frame_order_length`
// positions. Each index has one; at the other positions frame_order_at is -1.
int64_t frame_order_length(const struct frame_order *order, int64_t count);
int64_t frame_order_at(const struct frame_order *order, int64_t count, int64_t position);
