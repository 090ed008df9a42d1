// How much of a plan is made.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct plan_params;

// In the order in which they are done.
enum plan_stage {
    PLAN_STAGE_LIGHT,   // above order 1: pixels that random paths of reference/ measure
    PLAN_STAGE_HALVING, // renders in ever finer steps
    PLAN_STAGE_TRUTH,   // pixels that reference/ measures
    PLAN_STAGE_SEARCH,
    PLAN_STAGE_SCOUTS,
    PLAN_STAGE_PATHS,    // above order 1: pictures by random paths
    PLAN_STAGE_TIMING,   // larger renders; this and the next only of plans that are timed
    PLAN_STAGE_OVERHEAD, // the audit and the file of one
    PLAN_STAGE_COUNT
};

// Notes that `share` (0 to 1, more counts as 1) of what the stage may do at most is done, where `params` want to know.
// What was noted never falls. The next call of on_progress tells it.
void plan_progress_note(const struct plan_params *params, enum plan_stage stage, double share);
