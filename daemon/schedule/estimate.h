// How long a job's frames take and when it will be done, from its recent frames.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { ESTIMATE_RECENT = 63 };

// One a job. The zero value knows nothing.
struct estimate {
    float recent_s[ESTIMATE_RECENT]; // a ring
    uint8_t count, next;
    bool is_current; // median_s is of these durations
    float median_s;
};

void estimate_add(struct estimate *estimate, double seconds); // of one frame; not in [0, 1e9): ignored
size_t estimate_count(const struct estimate *estimate);       // durations it holds, at most ESTIMATE_RECENT
double estimate_median_s(struct estimate *estimate);          // > 0; 0: none known
// Seconds until `left` frames (queued and running) are done by `workers`; negative when that cannot be known.
double estimate_eta_s(struct estimate *estimate, int64_t left, int workers);
