// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_progress.h"

#include "worker/plan/plan_params.h"

#include <math.h>

// Of a plan that is not timed; set by hand, near the shares of the budget that the stages may take. Large frames take
// longer than all small renders.
static const double STAGE_SHARE[PLAN_STAGE_COUNT] = {
    [PLAN_STAGE_HALVING] = 0.3, [PLAN_STAGE_TRUTH] = 0.25, [PLAN_STAGE_SEARCH] = 0.35,
    [PLAN_STAGE_SCOUTS] = 0.1,  [PLAN_STAGE_TIMING] = 1.2, [PLAN_STAGE_OVERHEAD] = 0.3};

void plan_progress_note(const struct plan_params *params, enum plan_stage stage, double share)
{
    int stage_count = params->is_timed ? PLAN_STAGE_COUNT : PLAN_STAGE_TIMING;
    double done = STAGE_SHARE[stage] * fmin(share, 1.0), all = 0.0;

    if (!params->done) return;
    for (int i = 0; i < (int)stage; i++)
        done += STAGE_SHARE[i];
    for (int i = 0; i < stage_count; i++)
        all += STAGE_SHARE[i];
    *params->done = fmin(fmax(*params->done, done / all), 1.0);
}
