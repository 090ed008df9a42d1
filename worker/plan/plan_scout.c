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
static const double SHARE_WANTED = 0.6; // of the tolerance: the error of the worst frame, where the whole plan is finer
// Limits of the fall of an error by a rung, which is measured: by orders of 3 and 1.5 in the step.
static const double FALL_LEAST = 0.35355339059327379, FALL_MOST = 0.59460355750136051;

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
    return ok || !renderer_fault_is_final(scout->result.fault);
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
    double affordable = BUDGET_SHARE * plan_budget_find(params, rays), each;

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

// The index of the scout with the largest error.
static int find_worst(const struct plan_scouting *scouting)
{
    int worst = 0;

    for (int i = 1; i < scouting->count; i++)
        if (scouting->error[i] > scouting->error[worst]) worst = i;
    return worst;
}

static void refine_axis(struct plan *plan, const struct plan_scene *rays, int axis)
{
    plan->point.rungs[axis]++;
    plan->quality = plan_family_quality(&plan_families[plan->family], rays, &plan->point);
}

// Shares out the error of a frame among the axes: squared errors add up. An axis at its finest has none. False:
// scouting ends.
static bool blame_axes(struct scout *scout, const struct plan_scene *rays, int32_t frame, double frame_error,
                       double errors[static PLAN_AXIS_LIMIT], struct error *error)
{
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int count = plan_family_axes(&plan_families[scout->plan->family], rays, axes);
    double sum = 0.0;

    for (int i = 0; i < PLAN_AXIS_LIMIT; i++)
        errors[i] = 0.0;
    for (int i = 0; i < count; i++) {
        struct plan finer = *scout->plan;

        if (finer.point.rungs[i] >= plan_axis_last_rung(axes[i], rays)) continue;
        refine_axis(&finer, rays, i);
        scout->finer = plan_apply(&finer, scout->params->job);
        if (!measure_change(scout, frame, &errors[i], error)) return false;
        sum += errors[i] * errors[i];
    }
    for (int i = 0; i < count && sum > 0.0; i++)
        errors[i] *= frame_error / sqrt(sum);
    return true;
}

// Finds the factor by which a rung in all axes lowers the frame's error. False: scouting ends.
static bool find_fall(struct scout *scout, int32_t frame, double *fall, struct error *error)
{
    const struct job planned = scout->coarser;
    struct plan finer = *scout->plan;
    double first, second;
    bool ok;

    (void)plan_refine(&finer, scout->params->job, FINER_RUNGS);
    scout->finer = plan_apply(&finer, scout->params->job);
    ok = measure_change(scout, frame, &first, error);
    scout->coarser = scout->finer;
    (void)plan_refine(&finer, scout->params->job, FINER_RUNGS);
    scout->finer = plan_apply(&finer, scout->params->job);
    ok = ok && measure_change(scout, frame, &second, error);
    scout->coarser = planned;
    *fall = ok && first > 0.0 ? fmin(fmax(second / first, FALL_LEAST), FALL_MOST) : FALL_MOST;
    return ok;
}

// Refines the axes that are most to blame until the frame is expected to keep its tolerance.
static void refine_blamed(struct plan *plan, const struct plan_scene *rays, double errors[static PLAN_AXIS_LIMIT],
                          double fall, double wanted)
{
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int count = plan_family_axes(&plan_families[plan->family], rays, axes);

    for (;;) {
        double sum = 0.0;
        int worst = -1;

        for (int i = 0; i < count; i++) {
            sum += errors[i] * errors[i];
            if (plan->point.rungs[i] >= plan_axis_last_rung(axes[i], rays) || !(errors[i] > 0.0)) continue;
            if (worst < 0 || errors[i] > errors[worst]) worst = i;
        }
        if (worst < 0 || sqrt(sum) <= wanted) return;
        refine_axis(plan, rays, worst);
        errors[worst] *= fall;
    }
}

bool plan_scout_settle(struct plan *plan, const struct plan_params *params, const struct plan_scene *rays,
                       bool *is_finer, enum renderer_fault *fault, struct error *error)
{
    struct scout scout = {.plan = plan, .params = params};
    double errors[PLAN_AXIS_LIMIT], frame_error, fall;
    struct plan finer = *plan;
    int32_t frame;
    int worst;
    bool ok;

    *is_finer = false;
    if (plan->scouting.count == 0 || plan->work_ratio <= 1.0) return true;
    plan_lattice_init(&scout.lattice, params->job, PIXELS);
    scout.coarser = plan_apply(plan, params->job);
    worst = find_worst(&plan->scouting);
    frame = frame_range_at(&params->job->frames, plan_scouting_index(&plan->scouting, worst));
    frame_error = plan->scouting.error[worst];
    ok = find_fall(&scout, frame, &fall, error) && blame_axes(&scout, rays, frame, frame_error, errors, error);
    if (ok) {
        refine_blamed(&finer, rays, errors, fall, SHARE_WANTED * params->job->quality.tolerance);
        finer.work = plan_family_work(rays, &finer.quality);
        *is_finer = finer.work > plan->work && finer.work < plan->work_ratio * plan->work;
    } else {
        *fault = scout.result.fault;
    }
    if (*is_finer) {
        *plan = finer;
        plan->scouting.count = 0;
    }
    image_finish(&scout.fine);
    image_finish(&scout.coarse);
    plan_lattice_finish(&scout.lattice);
    return ok;
}
