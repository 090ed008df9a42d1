// The segments of a job, whose frames share a plan: a fixed number of frames each, in the order of the job's range.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct job;

enum { PLAN_SEGMENT_FRAMES = 48, PLAN_PILOT_LIMIT = 3 };

struct plan_segment {
    int64_t index;        // 0 is the first
    int64_t first, count; // by index in the job's range
    // The first, the middle and the last frame, sorted by number: a range written backwards has the same pilot.
    int32_t pilot[PLAN_PILOT_LIMIT];
    int pilot_count;
};

int64_t plan_segment_count(const struct job *job);
struct plan_segment plan_segment_at(const struct job *job, int64_t index);
// The segment of one of the job's frames.
struct plan_segment plan_segment_of(const struct job *job, int32_t frame);
// How many pictures the frames of a segment are: copies of one still picture count once.
double plan_segment_pictures(const struct job *job, const struct plan_segment *segment);
