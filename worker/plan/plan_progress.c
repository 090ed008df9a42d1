// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_progress.h"

#include "worker/plan/plan_params.h"

#include <math.h>

// Of the whole plan; set by hand, near the shares of the budget that the stages may take.
static const double STAGE_SHARE[PLAN_STAGE_COUNT] = {
    [PLAN_STAGE_HALVING] = 0.3, [PLAN_STAGE_TRUTH] = 0.25, [PLAN_STAGE_SEARCH] = 0.35, [PLAN_STAGE_SCOUTS] = 0.1};

void plan_progress_note(const struct plan_params *params, enum plan_stage stage, double share)
{
    double done = STAGE_SHARE[stage] * fmin(share, 1.0);

    if (!params->done) return;
    for (int i = 0; i < (int)stage; i++)
        done += STAGE_SHARE[i];
    *params->done = fmin(fmax(*params->done, done), 1.0);
}
