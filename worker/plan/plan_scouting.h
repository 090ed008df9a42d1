// A plan's error along its segment, measured at some frames, and by how much that refines a frame. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

enum { PLAN_SCOUT_LIMIT = 17 }; // odd: the pilot's middle frame is among them

struct plan_scouting {
    int count;           // of scouts; 0: only the pilot's frames were measured
    int64_t first, last; // the first and the last scout, by index in the job's range; the others lie evenly between
    double error[PLAN_SCOUT_LIMIT]; // relative RMSE that is expected of the unrefined plan
};

// The frame of scout `i`, by index in the job's range.
int64_t plan_scouting_index(const struct plan_scouting *scouting, int i);
// By how many rungs the plan is refined for a frame, given by its index in the job's range; 0: not at all.
int plan_scouting_find_rungs(const struct plan_scouting *scouting, int64_t index, double tolerance);
// The quadratic mean of the segment's errors, each frame refined as plan_scouting_find_rungs says.
double plan_scouting_predict_error(const struct plan_scouting *scouting, double tolerance);
