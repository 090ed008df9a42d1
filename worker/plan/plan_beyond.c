// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_beyond.h"

#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/audit/beyond.h"
#include "worker/audit/truth.h"
#include "worker/plan/draft.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_budget.h"
#include "worker/plan/plan_segment.h"
#include "worker/plan/plan_small.h"

#include <math.h>

static const double SHARE = 0.02;
// Evaluations that take as long as a draw with the look in reference/ that follows it: 45 to 200 ns of processor time
// in the examples.
static const double DRAW_WORK = 40.0;

double plan_beyond_find_limit(double work)
{
    return fmin(SHARE * work, PLAN_LINK_WORK) / DRAW_WORK;
}

static bool measure(const struct plan_params *params, const struct plan_segment *segment, double work,
                    const struct truth *truth, struct job_beyond *beyond)
{
    double start_s = clock_now_s(), limit = plan_beyond_find_limit(work), drawn;
    bool ok = beyond_measure(&(struct beyond_params){.job = params->job,
                                                     .frames = segment->pilot,
                                                     .frame_count = segment->pilot_count,
                                                     .inputs = truth ? truth_inputs(truth) : NULL,
                                                     .draws_most = limit,
                                                     .on_progress = plan_small_on_pixel,
                                                     .user = (void *)params},
                             beyond, &drawn);

    if (ok && beyond->is_known)
        log_debug("beyond: %.3g, at most %.3g, of the light; %.0f draws of %.0f in %.4f s", beyond->error,
                  beyond->error95, drawn, limit, clock_now_s() - start_s);
    return ok;
}

// The files that the audits of the frames will need are read once.
static struct truth *open_truth(const struct plan_params *params, const struct plan *plan)
{
    const struct plan_segment *segment = &params->segment;
    int32_t middle = segment->pilot[(segment->pilot_count - 1) / 2];
    struct job planned = plan_apply(plan, params->job);
    struct job_beyond beyond;

    if (!params->truth || !beyond_needs_paths(params->job, middle, &beyond)) return NULL;
    *params->truth = truth_open(&(struct truth_params){.job = &planned, .frame = middle}, NULL);
    return *params->truth;
}

bool plan_beyond_measure(struct plan *plan, const struct plan_params *params, enum renderer_fault *fault,
                         struct error *error)
{
    const struct job *job = params->job;
    double frames = plan_segment_pictures(job, &params->segment);
    double traced = (double)job->width_px * job->height_px * plan->predicted_traced;
    double work = frames * traced * plan->work * plan->work_ratio + plan->making_work;

    if (measure(params, &params->segment, params->is_timed ? INFINITY : work, open_truth(params, plan), &plan->beyond))
        return true;
    *fault = RENDERER_FAULT_STOPPED;
    error_set(error, "the frame was stopped");
    return false;
}

bool plan_beyond_measure_stated(const struct plan_params *params, struct job_beyond *beyond)
{
    const struct job *job = params->job;
    struct plan_segment segment = plan_segment_at(job, 0);

    return measure(params, &segment, draft_count(job) * job->width_px * job->height_px + PLAN_LINK_WORK, NULL, beyond);
}

bool plan_beyond_measure_asked(const struct plan_params *params, struct job_beyond *beyond)
{
    struct plan_segment segment = plan_segment_at(params->job, 0);

    return measure(params, &segment, INFINITY, NULL, beyond);
}
