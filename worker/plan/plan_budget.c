// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_budget.h"

#include "core/job/job.h"
#include "worker/plan/plan_family.h"
#include "worker/plan/plan_params.h"

#include <math.h>

// Set by hand: bench/contract shows what plans take. An evaluation takes 2 to 5 ns of processor time in software.
static const double SHARE = 0.05, SECOND = 8e8;

double plan_budget_find(const struct plan_params *params, const struct plan_scene *scene)
{
    struct plan_scene rays = *scene;
    double least = INFINITY;

    rays.pixels = (double)params->job->width_px * params->job->height_px;
    for (size_t i = 0; i < plan_family_count; i++) {
        const struct plan_family *family = &plan_families[i];
        struct plan_point start;
        struct job_quality quality;

        if (!plan_family_serves(family, &rays)) continue;
        start = plan_family_start(family, &rays, rays.small_level);
        quality = plan_family_quality(family, &rays, &start);
        least = fmin(least, plan_family_work(&rays, &quality));
    }
    if (isinf(least) || rays.depth_count == 0) return SECOND;
    return fmax(SHARE * least * rays.pixels * (double)params->segment.count, SECOND);
}
