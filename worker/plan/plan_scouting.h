// What scouts found of a plan's error along its segment, and how much finer that makes a frame. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

enum { PLAN_SCOUT_LIMIT = 17 }; // odd, so that the pilot's middle frame is among them

struct plan_scouting {
    int count;           // 0: nothing is known but of the pilot's frames
    int64_t first, last; // the first and the last frame, by index in the job's range; the others lie evenly between
    double error[PLAN_SCOUT_LIMIT]; // relative RMSE that is expected of the plan as it is
};

// The frame of scout `i`, by index in the job's range.
int64_t plan_scouting_index(const struct plan_scouting *scouting, int i);
// How many rungs finer than the plan a frame is rendered to begin with, by index in the job's range; 0: as planned.
int plan_scouting_find_rungs(const struct plan_scouting *scouting, int64_t index, double tolerance);
// The quadratic mean of the segment's errors once every frame is as fine as plan_scouting_find_rungs says.
double plan_scouting_predict_error(const struct plan_scouting *scouting, double tolerance);
