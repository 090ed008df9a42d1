// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/tolerance.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/audit/truth.h"
#include "worker/model/scene_features.h"
#include "worker/picture/image.h"
#include "worker/plan/finite_check.h"
#include "worker/plan/frame_audit.h"
#include "worker/plan/miss.h"
#include "worker/plan/plan_beyond.h"
#include "worker/plan/plan_lookup.h"
#include "worker/plan/plan_pixels.h"
#include "worker/plan/plan_probe.h"
#include "worker/plan/plan_retry.h"
#include "worker/plan/plan_return.h"
#include "worker/plan/plan_segment.h"
#include "worker/plan/plan_shelf.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The gain of a finer rendering that makes the next one finer too, instead of trying another family.
// Marches that bring scattered light differ by little, and after a miss more is known of what is to blame.
static const double GAIN = 0.7, SCATTERED_GAIN = 0.95;
// Above this share of a frame's error, most of its square is what interpolation adds: that is to blame.
static const double BLAMED = 0.71;
// Up to this share of the tolerance an error is no setting's fault: where it is not sure, more pixels are looked at.
static const double FINE = 0.5;

struct tolerance {
    struct renderer *renderer; // borrowed
    struct plan_shelf shelf;
    // The last job that states its method, whose light was found finite, and what its orders leave out; 0: none.
    int64_t finite_serial;
    struct job_beyond beyond;
    // The last frame, of which the renderer may make copies, if it was within its tolerance; else shown_serial is 0.
    int64_t shown_serial;
    struct tolerance_result shown;
    char shader_hash[HASH_TEXT_SIZE]; // of the last frame that is published although it missed its tolerance
};

struct tolerance *tolerance_create(struct renderer *renderer)
{
    struct tolerance *tolerance = xcalloc(1, sizeof *tolerance);

    tolerance->renderer = renderer;
    return tolerance;
}

void tolerance_destroy(struct tolerance *tolerance)
{
    if (!tolerance) return;
    plan_shelf_finish(&tolerance->shelf);
    free(tolerance);
}

static void note_phase(const struct tolerance_params *params, enum frame_phase phase)
{
    if (params->on_phase) params->on_phase(params->user, phase);
}

static void on_plan(void *user)
{
    note_phase(user, FRAME_PHASE_PLAN);
}

static void on_planned(void *user, double render_s)
{
    const struct tolerance_params *params = user;

    if (params->on_planned) params->on_planned(params->user, render_s);
}

static struct plan_shelf_params find_shelf_params(const struct tolerance *tolerance,
                                                  const struct tolerance_params *params)
{
    return (struct plan_shelf_params){.plan = {.renderer = tolerance->renderer,
                                               .job = params->job,
                                               .segment = plan_segment_of(params->job, params->frame),
                                               .choice = params->choice,
                                               .on_progress = params->on_progress,
                                               .user = params->user},
                                      .serial = params->serial,
                                      .source = params->source,
                                      .on_plan = on_plan,
                                      .on_planned = on_planned,
                                      .user = (void *)params};
}

// A frame, rendered until it is within its tolerance or given up.
struct rendering {
    struct tolerance *tolerance;
    const struct tolerance_params *params;
    struct plan_kept *kept;
    struct tolerance_result *result;
    struct error *error;
    bool is_asked;  // no setting is to blame, or none is left to try: the audit goes on until it is sure
    bool is_finer;  // or otherwise not what the plan's samples were measured in: its audit shares them with no frame
    bool is_cut;    // a rendering needed longer loops than GL runs: none is finer from then on
    double seconds; // of all renderings so far
    struct plan_retry retry;
    double changes[PLAN_AXIS_LIMIT]; // of the frame's pixels, with each axis of the latest plan; all 0: not known
    // The rendering with the least error so far, once one was over the tolerance.
    struct {
        struct plan plan;
        double changes[PLAN_AXIS_LIMIT];
        struct tolerance_result result;
        struct image image; // owned; empty where misses are not published
        char shader_hash[HASH_TEXT_SIZE];
    } best;
};

static struct plan_params probe_params(const struct rendering *rendering)
{
    return (struct plan_params){.renderer = rendering->tolerance->renderer,
                                .job = rendering->params->job,
                                .on_progress = rendering->params->on_progress,
                                .user = rendering->params->user};
}

// A copy has the error of the frame before where its own audit would have drawn the same pixels.
static bool audit(const struct rendering *rendering, const struct plan *plan)
{
    struct tolerance *tolerance = rendering->tolerance;
    struct tolerance_result *result = rendering->result;
    const struct plan_params looking = probe_params(rendering);

    note_phase(rendering->params, FRAME_PHASE_AUDIT);
    if (result->render.is_copy && tolerance->shown_serial == rendering->params->serial &&
        tolerance->shown.plan_number == result->plan_number && scene_is_constant(&rendering->params->job->scene)) {
        result->audit = tolerance->shown.audit;
        result->audit.seconds = 0.0;
        return true;
    }
    tolerance->shown_serial = 0;
    return frame_audit_run(&(struct frame_audit){.params = &looking,
                                                 .frame = rendering->params->frame,
                                                 .image = rendering->params->image,
                                                 .kept = rendering->kept,
                                                 .plan = plan,
                                                 .is_finer = rendering->is_finer,
                                                 .is_replaceable = rendering->retry.count == 0 &&
                                                                   !rendering->is_asked &&
                                                                   !rendering->params->repeated},
                           &result->audit, &result->render.fault, rendering->error);
}

// Only these have rays to cut, by which an audit draws some of its pixels.
static bool has_paths(const struct job *job)
{
    return scene_features_of(job, NULL).has_paths;
}

static bool render_and_audit(struct rendering *rendering, const struct plan *plan)
{
    const struct tolerance_params *params = rendering->params;
    struct tolerance_result *result = rendering->result;
    struct job planned = plan_apply(plan, params->job);

    result->quality = planned.quality;
    if (has_paths(params->job) && !image_ask_cut(params->image, rendering->error)) {
        result->render.fault = RENDERER_FAULT_FRAME;
        return false;
    }
    note_phase(params, FRAME_PHASE_RENDER);
    if (!renderer_render(rendering->tolerance->renderer,
                         &(struct renderer_frame){.job = &planned,
                                                  .frame = params->frame,
                                                  .image = params->image,
                                                  .on_progress = params->on_progress,
                                                  .on_level = params->on_level,
                                                  .user = params->user},
                         &result->render, rendering->error))
        return false;
    rendering->seconds += result->render.seconds;
    result->render.seconds = rendering->seconds;
    if (!finite_check_picture(rendering->tolerance->renderer, &planned, params->frame, params->image,
                              rendering->error)) {
        result->render.fault = RENDERER_FAULT_FRAME;
        return false;
    }
    if (!audit(rendering, plan)) return false;
    log_debug("tolerance: frame %d: %s error %.2e, at most %.2e, of %g, %.2e by interpolation, by %d pixels in %.3f s",
              (int)params->frame, job_method_name(plan->quality.method), result->audit.error, result->audit.error95,
              params->job->quality.tolerance, result->audit.interpolation_error, result->audit.ray_count,
              result->audit.seconds);
    return true;
}

// A rendering that GL cut is no reason to give up: its error is infinite.
static bool render_and_judge(struct rendering *rendering, const struct plan *plan)
{
    struct tolerance_result *result = rendering->result;

    if (render_and_audit(rendering, plan)) return true;
    if (result->render.fault != RENDERER_FAULT_ENDLESS) return false;
    rendering->is_cut = true;
    result->audit = (struct audit_result){.error = INFINITY, .error95 = INFINITY};
    return true;
}

// False for NaN, and for an error that is not a standard error within the tolerance.
static bool is_within(const struct rendering *rendering)
{
    const struct audit_result *audit = &rendering->result->audit;

    return audit->error + audit->spread <= rendering->params->job->quality.tolerance;
}

static bool keep_if_best(struct rendering *rendering, const struct plan *plan)
{
    const struct tolerance_result *result = rendering->result;
    double least = rendering->retry.count > 0 ? rendering->best.result.audit.error : NAN;

    if (!isnan(least) && !(result->audit.error < least)) return true;
    rendering->best.plan = *plan;
    memcpy(rendering->best.changes, rendering->changes, sizeof rendering->changes);
    rendering->best.result = *result;
    snprintf(rendering->best.shader_hash, sizeof rendering->best.shader_hash, "%s", result->render.shader_hash);
    return rendering->params->job->quality.on_miss != JOB_ON_MISS_PUBLISH ||
           image_copy(&rendering->best.image, rendering->params->image, rendering->error);
}

// False when it was stopped.
static bool find_changes(struct rendering *rendering, const struct plan *plan)
{
    const struct tolerance_params *params = rendering->params;
    const struct plan_params looking = probe_params(rendering);
    const struct plan_probe probe = {.params = &looking, .frame = params->frame, .plan = plan, .image = params->image};
    bool is_known = plan_retry_know(&rendering->retry, plan, rendering->changes);

    if (is_known && plan->quality.scatter_grid == 0) return true;
    return (is_known ? plan_probe_march : plan_probe_axes)(&probe, &rendering->retry, rendering->changes,
                                                           &rendering->result->render.fault, rendering->error);
}

static bool change_family(struct rendering *rendering, struct plan *plan)
{
    *plan = rendering->best.plan;
    memset(rendering->changes, 0, sizeof rendering->changes);
    return plan_retry_change_family(&rendering->retry, plan);
}

static bool choose_shorter(struct rendering *rendering, struct plan *plan)
{
    struct plan_retry *retry = &rendering->retry;
    bool is_cut = rendering->result->render.fault == RENDERER_FAULT_ENDLESS;

    return (is_cut && retry->count + 1 < PLAN_RETRY_LIMIT && plan_retry_shorten(retry, plan, 1 + retry->count)) ||
           plan_retry_change_family(retry, plan);
}

// Chooses the setting of the next rendering. `plan` has the last one's. False when there is none.
static bool choose_next(struct rendering *rendering, double error_before, struct plan *plan)
{
    const struct audit_result *best = &rendering->best.result.audit;
    double error = best->error, gain;

    if (rendering->is_cut) return choose_shorter(rendering, plan);
    if (best->interpolation_error > BLAMED * error) {
        *plan = rendering->best.plan;
        plan_pixels_refine(plan, best->interpolation_error, best->tolerance);
        return true;
    }
    *plan = rendering->best.plan;
    if (plan_pixels_refine_paths(plan, rendering->best.result.render.noise, error)) return true;
    gain = rendering->best.plan.quality.scatter_grid > 0 ? SCATTERED_GAIN : GAIN;
    if (rendering->retry.count > 0 && !(error <= gain * error_before) && change_family(rendering, plan)) return true;
    *plan = rendering->best.plan;
    memcpy(rendering->changes, rendering->best.changes, sizeof rendering->changes);
    return plan_retry_refine(&rendering->retry, plan, rendering->changes, error) || change_family(rendering, plan);
}

// What marks a published frame as missed. An error within the tolerance by less than its standard error does not.
static bool is_over(const struct tolerance_result *result)
{
    return !(result->audit.error <= result->audit.tolerance);
}

// Publishes the rendering with the least error, if the job asks for that and an error is known; else fails.
static bool miss(struct rendering *rendering)
{
    const struct tolerance_params *params = rendering->params;
    struct tolerance_result *result = rendering->result;
    struct tolerance *tolerance = rendering->tolerance;
    const struct plan_retry *retry = &rendering->retry;
    bool is_published;

    *result = rendering->best.result;
    result->retry_count = retry->count;
    if (result->render.fault == RENDERER_FAULT_ENDLESS) return false;
    result->render.seconds = rendering->seconds;
    memcpy(tolerance->shader_hash, rendering->best.shader_hash, sizeof tolerance->shader_hash);
    result->render.shader_hash = tolerance->shader_hash;
    is_published = params->job->quality.on_miss == JOB_ON_MISS_PUBLISH && isfinite(result->audit.error) &&
                   isfinite(result->audit.error95);
    result->audit.is_missed = is_published && is_over(result);
    if (is_published) return image_copy(params->image, &rendering->best.image, rendering->error);
    result->render.fault = RENDERER_FAULT_MISSED;
    miss_describe(&(struct miss){.job = params->job,
                                 .quality = &result->quality,
                                 .audit = &result->audit,
                                 .first_error = result->first_error,
                                 .rendering_count = 1 + retry->count,
                                 .work = 1.0 + retry->spent_work / retry->first_work},
                  rendering->error);
    return false;
}

// Audits the first rendering anew, by more pixels. False where it is over the tolerance.
static bool is_within_surely(struct rendering *rendering, const struct plan *first)
{
    bool is_known;

    if (rendering->result->audit.kind != AUDIT_REFERENCE) return false;
    rendering->is_asked = true;
    is_known = audit(rendering, first);
    rendering->is_asked = false;
    return is_known && is_within(rendering);
}

// `found` becomes the plan that keeps the tolerance, if one does.
static bool render_again(struct rendering *rendering, const struct plan *first, struct plan *found)
{
    struct plan_retry *retry = &rendering->retry;
    double error_before = INFINITY;
    struct plan plan = *first;
    bool is_fine = rendering->result->audit.error <= FINE * rendering->params->job->quality.tolerance;

    if (is_fine && is_within_surely(rendering, first)) return true;
    if (is_fine && renderer_fault_is_final(rendering->result->render.fault)) return false;
    plan_retry_init(retry, rendering->params->job, rendering->is_cut ? NULL : rendering->params->image, first);
    if (!keep_if_best(rendering, first) || (!rendering->is_cut && !find_changes(rendering, first))) return false;
    memcpy(rendering->best.changes, rendering->changes, sizeof rendering->changes);
    while (retry->count < PLAN_RETRY_LIMIT && choose_next(rendering, error_before, &plan)) {
        miss_describe_retry(&rendering->best.plan, rendering->best.result.audit.error, &plan,
                            rendering->result->reason);
        plan_retry_spend(retry, &plan, rendering->params->job->width_px, rendering->params->job->height_px);
        rendering->result->retry_count = ++retry->count;
        rendering->is_finer = true;
        error_before = rendering->best.result.audit.error;
        if (!render_and_judge(rendering, &plan)) {
            if (renderer_fault_is_final(rendering->result->render.fault)) return false;
            break;
        }
        if (is_within(rendering)) {
            *found = plan;
            plan_retry_settle(retry, &rendering->best.plan, rendering->best.result.audit.error, found,
                              rendering->result->audit.error);
            memcpy(found->reason, rendering->result->reason, sizeof found->reason);
            if (!rendering->is_cut || rendering->kept->plan.has_before) plan_return_note(found, &rendering->kept->plan);
            return true;
        }
        if (!keep_if_best(rendering, &plan)) return false;
    }
    if (retry->count == 0 && !is_fine) {
        if (is_within_surely(rendering, first)) return true;
        if (renderer_fault_is_final(rendering->result->render.fault) || !keep_if_best(rendering, first)) return false;
    }
    return miss(rendering);
}

static bool replace_plan(struct rendering *rendering, const struct plan *found)
{
    const struct tolerance_params *params = rendering->params;
    const struct plan_shelf_params shelf_params = find_shelf_params(rendering->tolerance, params);

    return plan_shelf_replace(&rendering->tolerance->shelf, &shelf_params, rendering->kept, params->frame, found,
                              &rendering->result->render.fault, rendering->error);
}

// Renders by the settings that the plan replaced, where the frame tries these. `is_done`: it is within its tolerance.
static bool try_before(struct rendering *rendering, bool *is_done)
{
    const struct tolerance_params *params = rendering->params;
    struct tolerance_result *result = rendering->result;
    struct plan before;

    *is_done = false;
    if (!plan_return_find(&rendering->kept->plan, params->job, params->frame, &before)) return true;
    memcpy(result->reason, before.reason, sizeof result->reason);
    if (!render_and_judge(rendering, &before)) return false;
    result->first_error = result->audit.error;
    *is_done = !rendering->is_cut && is_within(rendering);
    if (*is_done) return !plan_return_holds(&result->audit) || replace_plan(rendering, &before);
    rendering->is_cut = false;
    result->retry_count = 1;
    return true;
}

static bool render_planned(struct rendering *rendering)
{
    const struct tolerance_params *params = rendering->params;
    struct tolerance_result *result = rendering->result;
    const struct plan_shelf_params shelf_params = find_shelf_params(rendering->tolerance, params);
    struct plan plan, found;
    bool is_done, ok;

    rendering->kept =
        plan_shelf_find(&rendering->tolerance->shelf, &shelf_params, &result->render.fault, rendering->error);
    if (!rendering->kept) return false;
    result->plan_number = rendering->kept->number;
    result->beyond = rendering->kept->plan.beyond;
    result->weight = plan_frame_weight(&rendering->kept->plan, params->job, &shelf_params.plan.segment, params->frame);
    if (!try_before(rendering, &is_done)) return false;
    if (is_done) return true;
    plan = plan_of_frame(&rendering->kept->plan, params->job, params->frame);
    rendering->is_finer =
        rendering->kept->plan.has_before || memcmp(&plan.point, &rendering->kept->plan.point, sizeof plan.point) != 0;
    memcpy(result->reason, plan.reason, sizeof result->reason);
    if (!render_and_judge(rendering, &plan)) return false;
    if (result->retry_count == 0) result->first_error = result->audit.error;
    if (is_within(rendering)) {
        rendering->tolerance->shown_serial = rendering->params->serial;
        rendering->tolerance->shown = *rendering->result;
        return true;
    }
    ok = render_again(rendering, &plan, &found);
    image_finish(&rendering->best.image);
    return ok && (result->audit.is_missed || rendering->retry.count == 0 || replace_plan(rendering, &found));
}

static bool render_repeated(struct rendering *rendering)
{
    const struct tolerance_params *params = rendering->params;
    struct tolerance_result *result = rendering->result;
    struct plan plan = {.quality = *params->repeated, .pixels = params->repeated->pixels};
    struct plan_kept kept = {0};
    struct plan_scene scene;
    bool ok;

    plan.quality.pixels = (struct job_pixels){0};
    plan_scene_init(&scene, params->job);
    if (!plan_lookup(&scene, params->repeated, &plan.family, &plan.point)) {
        result->render.fault = RENDERER_FAULT_JOB;
        error_set(rendering->error, "marchd:quality: expected settings that a plan of this version chooses");
        return false;
    }
    rendering->kept = &kept;
    rendering->is_finer = true;
    result->plan_number = params->repeated_number;
    result->beyond = params->repeated_beyond;
    snprintf(result->reason, sizeof result->reason, "%s, as plan %" PRId64 " had it", plan_families[plan.family].name,
             params->repeated_number);
    ok = render_and_audit(rendering, &plan);
    result->first_error = result->audit.error;
    result->audit.is_missed = ok && is_over(result);
    truth_close(kept.truth);
    rendering->kept = NULL;
    return ok;
}

static bool give_up(enum renderer_fault *fault, struct error *error)
{
    *fault = RENDERER_FAULT_STOPPED;
    error_set(error, "the frame was stopped");
    return false;
}

// Once a job, a frame's first pixels tell whether its light is finite, and some paths what its orders leave out.
static bool render_stated(struct tolerance *tolerance, const struct tolerance_params *params,
                          struct tolerance_result *result, struct error *error)
{
    const struct plan_params looking = {
        .renderer = tolerance->renderer, .job = params->job, .on_progress = params->on_progress, .user = params->user};

    tolerance->shown_serial = 0;
    if (tolerance->finite_serial != params->serial) {
        if (!finite_check_frame(&looking, params->frame, &result->render.fault, error)) return false;
        if (!plan_beyond_measure_stated(&looking, &tolerance->beyond)) return give_up(&result->render.fault, error);
        tolerance->finite_serial = params->serial;
    }
    result->beyond = tolerance->beyond;
    return renderer_render(tolerance->renderer,
                           &(struct renderer_frame){.job = params->job,
                                                    .frame = params->frame,
                                                    .image = params->image,
                                                    .on_progress = params->on_progress,
                                                    .on_level = params->on_level,
                                                    .user = params->user},
                           &result->render, error);
}

bool tolerance_render(struct tolerance *tolerance, const struct tolerance_params *params,
                      struct tolerance_result *result, struct error *error)
{
    struct rendering rendering = {.tolerance = tolerance, .params = params, .result = result, .error = error};

    *result = (struct tolerance_result){.quality = params->job->quality};
    if (params->job->quality.method != JOB_METHOD_AUTO) return render_stated(tolerance, params, result, error);
    return params->repeated ? render_repeated(&rendering) : render_planned(&rendering);
}
