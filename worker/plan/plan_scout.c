// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_scout.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/audit/truth.h"
#include "worker/picture/audit_result.h"
#include "worker/picture/image.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_budget.h"
#include "worker/plan/plan_family.h"
#include "worker/plan/plan_lattice.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/plan_progress.h"
#include "worker/plan/plan_scouting.h"
#include "worker/render/renderer.h"

#include <math.h>

enum {
    PIXELS = 48 * 27, // of a frame that are drawn, at most
    FINER_RUNGS = 1, // one rung is cheap, and changes a frame by about its error: docs/rendering.md has the measurement
    COUNT_MIN = 5,   // fewer scouts are not worth it,
    COUNT_ALONE = 3  // unless reference/ cannot measure the pilot
};

// Limits of the ratio of error to change, which is taken from the pilot's frames. Measured were 0.7 to 1.6:
// docs/rendering.md.
static const double SCALE_LEAST = 0.75, SCALE_MOST = 1.25;
static const double BUDGET_SHARE = 0.1; // of the plan's budget: what the scouts may take

struct scout {
    struct plan *plan;
    const struct plan_params *params;
    struct job coarser, finer; // as planned and refined; they own nothing
    struct plan_lattice lattice;
    struct image coarse, fine;
    struct renderer_result result;
};

static double find_change(const struct image *coarse, const struct image *fine)
{
    size_t count = (size_t)fine->width_px * (size_t)fine->height_px;
    double squares = 0.0, light = 0.0;

    for (size_t i = 0; i < 4 * count; i++) {
        double difference = (double)coarse->rgba[i] - fine->rgba[i];

        if (i % 4 == 3) continue; // alpha
        squares += difference * difference / (3.0 * (double)count);
        light += (double)fine->rgba[i] * fine->rgba[i] / (3.0 * (double)count);
    }
    return sqrt(light > AUDIT_BLACK * AUDIT_BLACK ? squares / light : squares);
}

// A frame that cannot be rendered counts as unchanged: its own rendering will say why. False: scouting ends.
static bool measure_change(struct scout *scout, int32_t frame, double *change, struct error *error)
{
    const struct plan_params *params = scout->params;
    const struct plan_lattice *lattice = &scout->lattice;
    bool ok = plan_lattice_render(lattice, params, &scout->coarser, frame, &scout->coarse, &scout->result, error) &&
              plan_lattice_render(lattice, params, &scout->finer, frame, &scout->fine, &scout->result, error);

    *change = ok ? find_change(&scout->coarse, &scout->fine) : 0.0;
    if (!isfinite(*change)) *change = 0.0;
    return ok || (scout->result.fault != RENDERER_FAULT_STOPPED && scout->result.fault != RENDERER_FAULT_CONTEXT);
}

static double square_mean(const double *values, int first, int last, int by)
{
    double sum = 0.0;
    int count = 0;

    for (int i = first; i <= last; i += by, count++)
        sum += values[i] * values[i];
    return sqrt(sum / count);
}

// The pilot's frames are the first, the middle and the last scout. Where reference/ has not measured them, the changes
// are left as they are: the pilot's finest render may have the plan's error too.
static void scale_errors(struct plan_scouting *scouting, double pilot_error, const struct job *job)
{
    double change = square_mean(scouting->error, 0, scouting->count - 1, (scouting->count - 1) / 2);
    double scale = change > 0.0 ? fmin(fmax(pilot_error / change, SCALE_LEAST), SCALE_MOST) : 1.0;

    for (int i = 0; truth_has_twin(job) && i < scouting->count; i++)
        scouting->error[i] *= scale;
}

static bool is_of_use(const struct plan_params *params)
{
    const struct scene *scene = &params->job->scene;
    bool reads_each = false;

    for (size_t i = 0; i < scene->medium_count; i++)
        reads_each |=
            scene->media[i].density.kind == SCENE_DENSITY_GRID && scene_density_is_sequence(&scene->media[i].density);
    return !reads_each && !scene_is_constant(scene) && params->segment.count > 2;
}

// The largest odd number of scouts that the work allows.
static int count_scouts(const struct plan *plan, const struct plan *finer, const struct plan_params *params,
                        const struct plan_scene *rays)
{
    struct plan_scene scene = *rays;
    int64_t count = params->segment.count < PLAN_SCOUT_LIMIT ? params->segment.count : PLAN_SCOUT_LIMIT;
    double affordable = BUDGET_SHARE * plan_budget_find(params), each;

    scene.pixels = fmin((double)params->job->width_px * params->job->height_px, PIXELS);
    each = scene.pixels * (plan_family_work(&scene, &plan->quality) + plan_family_work(&scene, &finer->quality));
    count = (int64_t)fmin((double)count, affordable / each);
    if (count < COUNT_MIN) count = truth_has_twin(params->job) ? 0 : COUNT_ALONE;
    return count > 0 ? (int)((count - 1) / 2 * 2 + 1) : 0;
}

bool plan_scout_measure(struct plan *plan, const struct plan_params *params, const struct plan_scene *rays,
                        enum renderer_fault *fault, struct error *error)
{
    struct plan_scouting scouting = {.first = params->segment.first,
                                     .last = params->segment.first + params->segment.count - 1};
    struct scout scout = {.plan = plan, .params = params};
    struct plan finer = *plan;
    bool ok = true;

    if (is_of_use(params) && plan_refine(&finer, params->job, FINER_RUNGS))
        scouting.count = count_scouts(plan, &finer, params, rays);
    if (scouting.count == 0) {
        if (plan->scouting.count > 0)
            plan->predicted_error = plan_scouting_predict_error(&plan->scouting, params->job->quality.tolerance);
        return true;
    }
    plan_lattice_init(&scout.lattice, params->job, PIXELS);
    scout.coarser = plan_apply(plan, params->job);
    scout.finer = plan_apply(&finer, params->job);
    for (int i = 0; ok && i < scouting.count; i++) {
        ok = measure_change(&scout, frame_range_at(&params->job->frames, plan_scouting_index(&scouting, i)),
                            &scouting.error[i], error);
        plan_progress_note(params, PLAN_STAGE_SCOUTS, (i + 1.0) / scouting.count);
    }
    if (ok) {
        scale_errors(&scouting, plan->predicted_error, params->job);
        plan->predicted_error = plan_scouting_predict_error(&scouting, params->job->quality.tolerance);
        plan->scouting = scouting;
    } else {
        *fault = scout.result.fault;
    }
    image_finish(&scout.fine);
    image_finish(&scout.coarse);
    plan_lattice_finish(&scout.lattice);
    return ok;
}
