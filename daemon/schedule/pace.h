// What a worker's time goes into: frames, and plans, which may begin while the frame before is encoded.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

// One per worker, with times in nanoseconds of a monotonic clock. The zero value: nothing was done yet.
struct pace {
    uint64_t answered_ns; // its latest answer about a frame, or the assignment of a frame when it had none
    int64_t job;          // of that answer; 0: none yet
    uint64_t planning_ns; // when it began the plan that it makes; 0: it makes none
    double planned_s;     // seconds of plans since answered_ns
};

void pace_begin(struct pace *pace, uint64_t now_ns); // a frame is assigned to a worker that had none
void pace_begin_plan(struct pace *pace, uint64_t now_ns);
// Returns the seconds that the plan took; negative when none was begun.
double pace_end_plan(struct pace *pace, uint64_t now_ns);
void pace_drop_plan(struct pace *pace); // the plan that it makes comes to nothing
// An answer about a frame of the job. Returns the seconds since the one before, without those of plans. `is_first` (may
// be NULL): it is the worker's first of the job or after a plan.
double pace_answer(struct pace *pace, int64_t job, uint64_t now_ns, bool *is_first);
