// When jobs are done: each behind those in front of it, whose frames its workers take first, and beside other owners'.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct eta_lane;
struct eta_place;
struct farm;
struct job_record;

// What the jobs with frames to take have left, at the moment when it is first needed. The zero value has not looked.
struct job_etas {
    struct eta_lane *lanes; // owned; by priority, the highest first
    size_t lane_count, lane_capacity;
    struct eta_place *places; // owned; of each lane's jobs, by id
    size_t place_count, place_capacity;
    bool is_filled;
};

// Seconds until the job is done; negative: unknown. For many jobs at a time the first walks all that have frames to
// take, and none does after it.
double job_etas_find_s(struct job_etas *etas, const struct farm *farm, struct job_record *record);
void job_etas_finish(struct job_etas *etas); // accepts the zero value
