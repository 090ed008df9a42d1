// Which frames of a job share a plan: stretches of a fixed number of frames, in the order of the job's range.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct job;

enum { PLAN_SEGMENT_FRAMES = 48, PLAN_PILOT_LIMIT = 3 };

struct plan_segment {
    int64_t index;        // 0 is the first
    int64_t first, count; // by index in the job's range
    // Its first, its middle and its last frame, in the order of their numbers: a range that is written backwards has the
    // same.
    int32_t pilot[PLAN_PILOT_LIMIT];
    int pilot_count;
};

int64_t plan_segment_count(const struct job *job);
struct plan_segment plan_segment_at(const struct job *job, int64_t index);
// The segment of a frame of the job's.
struct plan_segment plan_segment_of(const struct job *job, int32_t frame);
