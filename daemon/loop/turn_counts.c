// SPDX-License-Identifier: Apache-2.0
#include "daemon/loop/turn_counts.h"

enum { NS_PER_MS = 1000 * 1000 };

const int64_t turn_class_ms[TURN_CLASS_COUNT - 1] = {1, 2, 5, 10, 20, 50, 100, 200, 1000};

void turn_counts_add(struct turn_counts *counts, int64_t turn_ns)
{
    int class = 0;

    while (class < TURN_CLASS_COUNT - 1 && turn_ns > turn_class_ms[class] * NS_PER_MS)
        class ++;
    counts->counts[class]++;
    counts->sum_ns += turn_ns;
    if (turn_ns > counts->longest_ns) counts->longest_ns = turn_ns;
}
