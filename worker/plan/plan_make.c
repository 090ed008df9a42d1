// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_make.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/job/step_check.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_beyond.h"
#include "worker/plan/plan_budget.h"
#include "worker/plan/plan_evidence.h"
#include "worker/plan/plan_family.h"
#include "worker/plan/plan_overhead.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/plan_pilot.h"
#include "worker/plan/plan_pixels.h"
#include "worker/plan/plan_progress.h"
#include "worker/plan/plan_scatter.h"
#include "worker/plan/plan_scout.h"
#include "worker/plan/plan_search.h"
#include "worker/plan/plan_time.h"
#include "worker/plan/scatter_evidence.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FINEST_RUNGS = 6, FAMILY_LIMIT = 16 };

// These four were set by hand. tests/worker/plan/tolerance_random_test checks what they promise, and bench/predictions
// shows what they cost.
static const double SHARE = 0.65;       // of the tolerance: the error that a search aims at
static const double SHARE_UNSEEN = 0.8; // of the tolerance: the error allowed in frames that the walk did not measure
static const double SEARCH_SHARE = 0.2; // of the budget: of a family, once some setting keeps the target
static const double SEARCH_MOST = 0.4;  // of the budget: of all families
static const double WORK_LIMIT = 8.0;   // of a setting, relative to the pilot's finest render
// Relative RMSE of rounding to half, for evenly spread digits: 2^-11 / sqrt(3) of the value's power of two.
static const double HALF_ROUNDING = 2.0e-4;

// The search within one family.
struct attempt {
    const struct plan_params *params;
    const struct plan_family *family;
    const struct plan_scene *scene;
    struct plan_pilot *pilot;
    bool is_half;
    int frame; // of the pilot: the one that is measured, the worst
    double target;
    double first_evaluations; // the pilot's count before this search
    double budget;            // of the whole plan
    bool is_found;            // some setting keeps the target, of this family or of one before
};

static double find_work(void *user, const struct plan_point *point)
{
    const struct attempt *attempt = user;
    struct job_quality quality = plan_family_quality(attempt->family, attempt->scene, point);

    return plan_family_work(attempt->scene, &quality);
}

static double with_rounding(double error, bool is_half)
{
    return is_half ? hypot(error, HALF_ROUNDING) : error;
}

static bool is_spent(const struct attempt *attempt)
{
    double all = plan_pilot_count_evaluations(attempt->pilot), own = all - attempt->first_evaluations;

    if (attempt->is_found && own > SEARCH_SHARE * attempt->budget) return true;
    return own > 0.0 && all > SEARCH_MOST * attempt->budget;
}

static enum plan_measured measure(void *user, const struct plan_point *point, double *error)
{
    struct attempt *attempt = user;
    struct job_quality quality = plan_family_quality(attempt->family, attempt->scene, point);
    struct plan_errors errors;
    enum plan_measured measured;

    if (is_spent(attempt)) return PLAN_CANNOT;
    measured = plan_pilot_measure(attempt->pilot, &quality, attempt->frame, &errors);
    plan_progress_note(attempt->params, PLAN_STAGE_SEARCH,
                       plan_pilot_count_evaluations(attempt->pilot) / (SEARCH_MOST * attempt->budget));
    if (attempt->frame == PLAN_ALL_FRAMES) attempt->frame = errors.worst;
    *error = with_rounding(errors.largest, attempt->is_half);
    attempt->is_found |= measured == PLAN_MEASURED && *error <= attempt->target;
    if (measured == PLAN_MEASURED)
        log_debug("plan: %s step %g %g, light %g %g grid %d points %d least %g: error %.2e, work %.0f",
                  attempt->family->name, quality.step, quality.step_voxels, quality.light_step,
                  quality.light_step_voxels, quality.light_grid, quality.points, quality.min_transmittance, *error,
                  plan_family_work(attempt->scene, &quality));
    return measured;
}

static struct plan_point find_start(const struct attempt *attempt)
{
    return plan_family_start(attempt->family, attempt->scene, plan_pilot_start_level(attempt->pilot));
}

// The start is measured in all frames; the walk then measures only the worst of them.
static struct plan_finding walk(struct attempt *attempt, struct plan_point start, double work_limit)
{
    struct plan_search search = {.target = attempt->target,
                                 .work_limit = work_limit,
                                 .start = start,
                                 .work = find_work,
                                 .measure = measure,
                                 .user = attempt};
    enum plan_axis axes[PLAN_AXIS_LIMIT];

    attempt->frame = PLAN_ALL_FRAMES;
    search.axis_count = plan_family_axes(attempt->family, attempt->scene, axes);
    for (int i = 0; i < search.axis_count; i++)
        search.last_rung[i] = plan_axis_last_rung(axes[i], attempt->scene);
    return plan_search_run(&search);
}

// The walk goes on from its result while the worst of all frames is over SHARE_UNSEEN of the tolerance: then it is not
// the frame that the walk measured.
static struct plan_finding search(struct attempt *attempt, double tolerance, double work_limit)
{
    struct plan_finding finding = walk(attempt, find_start(attempt), work_limit);

    for (int again = 1; again < PLAN_PILOT_LIMIT && finding.found == PLAN_FOUND; again++) {
        struct job_quality quality = plan_family_quality(attempt->family, attempt->scene, &finding.point);
        struct plan_finding before;
        struct plan_errors errors;

        if (plan_pilot_measure(attempt->pilot, &quality, PLAN_ALL_FRAMES, &errors) != PLAN_MEASURED) {
            finding.found = PLAN_GAVE_UP;
            break;
        }
        finding.error = with_rounding(errors.largest, attempt->is_half);
        if (finding.error <= SHARE_UNSEEN * tolerance) break;
        before = finding;
        attempt->is_found = false;
        finding = walk(attempt, finding.point, work_limit);
        // Where the budget ends the walk, the frames over the tolerance are refined by themselves: plan_scouting.h.
        if (finding.found == PLAN_OVER_LIMIT || finding.found == PLAN_MISSED) return before;
    }
    return finding;
}

// The best setting found so far, and the families that were tried.
struct choice {
    struct plan_finding finding;
    size_t family;
    bool is_found, is_cheap; // is_cheap: no other family would repay its linking
    int serve_count;
    int link_count;  // of programs, that of the pilot's own family included
    char tried[160]; // the names of the families, and the work of their best settings
};

static void note_tried(struct choice *choice, const struct plan_family *family, const struct plan_finding *finding)
{
    size_t length = strlen(choice->tried);

    snprintf(choice->tried + length, sizeof choice->tried - length, "%s%s %s%.0f", length > 0 ? ", " : "", family->name,
             finding->found == PLAN_FOUND ? "" : "over ", finding->work);
}

static bool is_better(const struct choice *choice, const struct plan_finding *finding)
{
    if (finding->found == PLAN_FOUND) return !choice->is_found || finding->work < choice->finding.work;
    return !choice->is_found && finding->error < choice->finding.error;
}

// The families that serve the scene, sorted by the work of the settings at which their walks begin. Returns their
// number.
static int sort_families(struct plan_pilot *pilot, size_t families[static FAMILY_LIMIT],
                         double works[static FAMILY_LIMIT])
{
    const struct plan_scene *scene = plan_pilot_scene(pilot);
    int count = 0;

    for (size_t i = 0; i < plan_family_count && count < FAMILY_LIMIT; i++) {
        struct attempt attempt = {.family = &plan_families[i], .scene = scene, .pilot = pilot};
        struct plan_point start;
        double work;
        int at = count;

        if (!plan_family_serves(attempt.family, scene)) continue;
        start = find_start(&attempt);
        work = find_work(&attempt, &start);
        for (; at > 0 && works[at - 1] > work; at--) {
            works[at] = works[at - 1];
            families[at] = families[at - 1];
        }
        works[at] = work;
        families[at] = i;
        count++;
    }
    return count;
}

// True if a family that begins with that work may save more in the segment's frames than linking its program takes.
static bool repays(const struct choice *choice, double work, const struct plan_params *params)
{
    double pixels = (double)params->job->width_px * params->job->height_px * (double)params->segment.count;

    return (choice->finding.work - work) * pixels > PLAN_LINK_WORK;
}

// False when the search was stopped.
static bool choose(struct plan_pilot *pilot, const struct plan_params *params, struct choice *choice)
{
    const struct job *job = params->job;
    size_t families[FAMILY_LIMIT];
    double works[FAMILY_LIMIT], work_limit = WORK_LIMIT * plan_pilot_fine_work(pilot);
    int count = sort_families(pilot, families, works);

    *choice = (struct choice){
        .finding = {.error = INFINITY}, .family = plan_family_count, .serve_count = count, .link_count = 1};
    for (int i = 0; i < count; i++) {
        struct attempt attempt = {.params = params,
                                  .family = &plan_families[families[i]],
                                  .scene = plan_pilot_scene(pilot),
                                  .pilot = pilot,
                                  .is_half = job->output.pixel == JOB_PIXEL_HALF,
                                  .target = SHARE * job->quality.tolerance,
                                  .first_evaluations = plan_pilot_count_evaluations(pilot),
                                  .budget = plan_budget_find(params, plan_pilot_scene(pilot)),
                                  .is_found = choice->is_found};
        struct plan_finding finding;

        // A family that begins with more work rarely ends with less, and then gains little.
        if (choice->is_found && works[i] >= choice->finding.work) break;
        choice->is_cheap = choice->is_found && !repays(choice, works[i], params);
        if (choice->is_cheap) break;
        finding = search(&attempt, job->quality.tolerance, choice->is_found ? choice->finding.work : work_limit);
        if (finding.found == PLAN_GAVE_UP) return false;
        note_tried(choice, attempt.family, &finding);
        if (attempt.family != plan_pilot_finest(pilot)) choice->link_count++;
        if (!is_better(choice, &finding)) continue;
        choice->finding = finding;
        choice->family = families[i];
        choice->is_found = finding.found == PLAN_FOUND;
    }
    return true;
}

static void describe(struct plan *plan, const struct job *job, const struct choice *choice)
{
    const char *name = plan_families[plan->family].name;

    if (!choice->is_found)
        snprintf(plan->reason, sizeof plan->reason, "%s comes nearest to %g: nothing that was tried keeps it", name,
                 job->quality.tolerance);
    else if (choice->serve_count == 1)
        snprintf(plan->reason, sizeof plan->reason, "%s alone serves this scene", name);
    else if (choice->is_cheap)
        snprintf(plan->reason, sizeof plan->reason,
                 "%s does so little work here that no other method repays linking it", name);
    else if (!strchr(choice->tried, ','))
        snprintf(plan->reason, sizeof plan->reason, "%s begins with less work than others end with", name);
    else
        snprintf(plan->reason, sizeof plan->reason,
                 "%s does the least work for %g of the tolerance, evaluations a pixel: %s", name, SHARE, choice->tried);
}

static void force(struct plan *plan, const struct plan_params *params, const struct plan_scene *scene)
{
    if (params->choice == PLAN_CHOICE_COARSEST) {
        plan->point = (struct plan_point){.rungs = {0}};
        plan->quality = plan_family_quality(&plan_families[plan->family], scene, &plan->point);
    }
    if (params->choice == PLAN_CHOICE_FINEST) (void)plan_refine(plan, params->job, FINEST_RUNGS);
    plan->work = plan_family_work(scene, &plan->quality);
}

// The pilot's frames are the first, the middle and the last, unless one could not be rendered.
static void note_frames(struct plan *plan, const struct plan_params *params, const struct plan_errors *errors)
{
    const struct plan_segment *segment = &params->segment;

    if (params->choice != PLAN_CHOICE_CHEAPEST || errors->count != PLAN_PILOT_LIMIT) return;
    plan->scouting = (struct plan_scouting){
        .count = errors->count, .first = segment->first, .last = segment->first + segment->count - 1};
    memcpy(plan->scouting.error, errors->each, sizeof errors->each);
}

// The work of each frame is counted by the pilot's rays.
static void find_work_ratio(struct plan *plan, const struct plan_params *params, const struct plan_scene *scene)
{
    const struct plan_scouting *scouting = &plan->scouting;
    double sum = 0.0;

    plan->work_ratio = 1.0;
    if (scouting->count == 0) return;
    for (int64_t i = scouting->first; i <= scouting->last; i++) {
        struct plan of_frame = plan_of_frame(plan, params->job, frame_range_at(&params->job->frames, i));

        sum += plan_family_work(scene, &of_frame.quality) / plan_family_work(scene, &plan->quality);
    }
    plan->work_ratio = sum / (double)(scouting->last - scouting->first + 1);
}

static void begin(struct plan *plan, const struct plan_params *params, const struct plan_scene *scene,
                  const struct choice *choice)
{
    *plan = (struct plan){.family = choice->family, .point = choice->finding.point};
    plan->quality = plan_family_quality(&plan_families[plan->family], scene, &plan->point);
    describe(plan, params->job, choice);
    force(plan, params, scene);
}

// Measures the plan in the pilot's frames, and scouts others.
static bool measure_frames(struct plan *plan, const struct plan_params *params, struct plan_pilot *pilot,
                           enum renderer_fault *fault, struct error *error)
{
    struct plan_errors errors;

    if (plan_pilot_measure(pilot, &plan->quality, PLAN_ALL_FRAMES, &errors) != PLAN_MEASURED) {
        *fault = plan_pilot_fault(pilot, error);
        return false;
    }
    plan->predicted_error = errors.mean;
    note_frames(plan, params, &errors);
    if (params->choice == PLAN_CHOICE_CHEAPEST &&
        !plan_scout_measure(plan, params, plan_pilot_scene(pilot), fault, error))
        return false;
    find_work_ratio(plan, params, plan_pilot_scene(pilot));
    return true;
}

static bool finish(struct plan *plan, const struct plan_params *params, struct plan_pilot *pilot,
                   enum renderer_fault *fault, struct error *error)
{
    bool is_finer;

    if (!measure_frames(plan, params, pilot, fault, error)) return false;
    if (!plan_scout_settle(plan, params, plan_pilot_scene(pilot), &is_finer, fault, error)) return false;
    if (is_finer && !measure_frames(plan, params, pilot, fault, error)) return false;
    plan->predicted_error = with_rounding(plan->predicted_error, params->job->output.pixel == JOB_PIXEL_HALF);
    if (params->evidence) plan_pilot_give(pilot, params->evidence);
    return true;
}

static bool choose_plan(struct plan *plan, const struct plan_params *params, enum renderer_fault *fault,
                        struct error *error)
{
    struct plan_pilot *pilot = plan_pilot_create(params, fault, error);
    struct choice choice;
    bool ok;

    if (!pilot) return false;
    ok = choose(pilot, params, &choice) && choice.family < plan_family_count;
    if (!ok) *fault = plan_pilot_fault(pilot, error);
    if (ok) {
        begin(plan, params, plan_pilot_scene(pilot), &choice);
        ok = finish(plan, params, pilot, fault, error);
    }
    if (!ok && *fault == RENDERER_FAULT_NONE) {
        *fault = RENDERER_FAULT_MISSED;
        error_set(error, "quality.tolerance: no method's light is finite in small pictures of the segment; expected "
                         "densities, numbers and files without NaN and infinity");
    }
    if (ok) plan->making_work = plan_pilot_count_evaluations(pilot) + choice.link_count * PLAN_LINK_WORK;
    if (ok)
        log_debug("plan: segment %d: %s; predicted error %.2e of %g, %.2f times the work with frames that are finer, "
                  "%d small renders",
                  (int)params->segment.index, plan->reason, plan->predicted_error, params->job->quality.tolerance,
                  plan->work_ratio, plan_pilot_count_renders(pilot));
    plan_pilot_destroy(pilot);
    return ok;
}

// What was measured of the first order says nothing of the frames.
static void forget_evidence(struct plan_evidence *evidence)
{
    struct job_quality finest = evidence->finest;
    int pixel_limit = evidence->pixel_limit;

    plan_evidence_finish(evidence);
    evidence->finest = finest;
    evidence->pixel_limit = pixel_limit;
}

// Where marches have no end, there is no plan of the first order: paths show it with all others.
static bool choose_first(struct plan *plan, const struct plan_params *params, enum renderer_fault *fault,
                         struct error *error)
{
    if (step_has_end(params->job)) return choose_plan(plan, params, fault, error);
    *plan = (struct plan){.family = plan_family_count, .work_ratio = 1.0};
    return true;
}

static bool choose_scattered(struct plan *plan, const struct plan_params *params, enum renderer_fault *fault,
                             struct error *error)
{
    struct plan_scatter *scatter = plan_scatter_create(params, fault, error);
    struct plan_params first_params = *params;
    struct job first;
    bool ok;

    if (!scatter) return false;
    first = plan_scatter_first_job(scatter);
    first_params.job = &first;
    ok = choose_first(plan, &first_params, fault, error);
    if (ok && params->evidence) forget_evidence(params->evidence);
    ok = ok && plan_scatter_complete(scatter, plan, fault, error) &&
         (!params->evidence || scatter_evidence_measure(plan, params, params->evidence, fault, error));
    plan_scatter_destroy(scatter);
    return ok;
}

bool plan_make(struct plan *plan, const struct plan_params *params, enum renderer_fault *fault, struct error *error)
{
    struct plan_evidence evidence = {0};
    struct plan_params chosen = *params;
    double start_s = clock_now_s(), done = 0.0;
    bool ok;

    chosen.done = &done;
    chosen.is_scattered = params->job->scene.orders > 1;
    if (params->is_timed && !params->evidence) chosen.evidence = &evidence;
    ok = (params->job->scene.orders == 1 ? choose_plan : choose_scattered)(plan, &chosen, fault, error);
    ok = ok && plan_pixels_choose(plan, &chosen, fault, error);
    if (ok) plan->plan_s = clock_now_s() - start_s;
    ok = ok && plan_beyond_measure(plan, &chosen, fault, error);
    if (params->is_timed)
        ok = ok && plan_time_predict(plan, &chosen, fault, error) &&
             plan_overhead_predict(plan, &chosen, chosen.evidence, fault, error);
    plan_evidence_finish(&evidence);
    return ok;
}
