// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_budget.h"

#include "core/job/job.h"
#include "worker/plan/plan_params.h"

#include <math.h>

// Set by hand: bench/contract shows what plans take. An evaluation takes 2 to 5 ns of processor time in software.
static const double SHARE = 0.05, SECOND = 8e8;
static const double PIXEL = 50.0; // evaluations of a sample, of scenes that need few

double plan_budget_find(const struct plan_params *params)
{
    const struct job *job = params->job;
    double samples = (double)job->width_px * job->height_px * job->quality.samples;

    return fmax(SHARE * PIXEL * samples * (double)params->segment.count, SECOND);
}
