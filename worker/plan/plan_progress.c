// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_progress.h"

#include "worker/plan/plan_params.h"

#include <math.h>

// Of a plan that is not timed; set by hand, near the shares of the budget that the stages may take. Large frames take
// longer than all small renders.
static const double STAGE_SHARE[PLAN_STAGE_COUNT] = {
    [PLAN_STAGE_LIGHT] = 3.0,  [PLAN_STAGE_HALVING] = 0.3, [PLAN_STAGE_TRUTH] = 0.25, [PLAN_STAGE_SEARCH] = 0.35,
    [PLAN_STAGE_SCOUTS] = 0.1, [PLAN_STAGE_PATHS] = 1.5,   [PLAN_STAGE_TIMING] = 1.2, [PLAN_STAGE_OVERHEAD] = 0.3};

static double share_of(const struct plan_params *params, enum plan_stage stage)
{
    if (stage >= PLAN_STAGE_TIMING && !params->is_timed) return 0.0;
    if ((stage == PLAN_STAGE_LIGHT || stage == PLAN_STAGE_PATHS) && !params->is_scattered) return 0.0;
    return STAGE_SHARE[stage];
}

void plan_progress_note(const struct plan_params *params, enum plan_stage stage, double share)
{
    double done = share_of(params, stage) * fmin(share, 1.0), all = 0.0;

    if (!params->done) return;
    for (int i = 0; i < PLAN_STAGE_COUNT; i++) {
        if (i < (int)stage) done += share_of(params, (enum plan_stage)i);
        all += share_of(params, (enum plan_stage)i);
    }
    *params->done = fmin(fmax(*params->done, done / all), 1.0);
}
