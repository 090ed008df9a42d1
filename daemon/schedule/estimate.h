// Estimates of frame time and remaining time of a job, from its recent frames.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { ESTIMATE_RECENT = 63 };

// One per job. The zero value holds no durations.
struct estimate {
    float recent_s[ESTIMATE_RECENT]; // a ring buffer
    uint8_t count, next;
    bool is_current; // median_s is the median of these durations
    float median_s;
};

void estimate_add(struct estimate *estimate, double seconds); // of one frame; ignored unless in [0, 1e9)
size_t estimate_count(const struct estimate *estimate);       // number of durations, at most ESTIMATE_RECENT
double estimate_median_s(struct estimate *estimate);          // 0: no durations
// Seconds until `workers` have done `left` frames (queued and running); negative when unknown.
double estimate_eta_s(struct estimate *estimate, int64_t left, int workers);
