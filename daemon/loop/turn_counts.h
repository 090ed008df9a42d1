// How long the turns of the loop were: counts by length, and the longest. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

// Classes of length; the last has no upper end.
enum { TURN_CLASS_COUNT = 10 };
extern const int64_t turn_class_ms[TURN_CLASS_COUNT - 1]; // the upper end of each class but the last, ascending

// The zero value has counted nothing.
struct turn_counts {
    uint64_t counts[TURN_CLASS_COUNT];
    int64_t longest_ns, sum_ns;
};

void turn_counts_add(struct turn_counts *counts, int64_t turn_ns);
