// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/frame_audit.h"

#include "core/base/error.h"
#include "worker/audit/audit.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/plan/pixel_audit.h"
#include "worker/plan/plan_evidence.h"
#include "worker/plan/plan_probe.h"
#include "worker/plan/plan_shelf.h"
#include "worker/plan/plan_small.h"

enum { VIEW_PIXELS = 64 * 36 }; // of pictures in two steps, where a plan has no views

// An audit that is under way.
struct auditing {
    const struct frame_audit *audit;
    const struct job *planned;
    struct pixel_audit pixels;
    bool is_joined; // what interpolated pixels add is judged apart, and joined with what the traced ones lack
    enum renderer_fault *fault;
    struct error *error;
};

static bool open_truth(const struct auditing *auditing)
{
    struct plan_kept *kept = auditing->audit->kept;
    int32_t frame = auditing->audit->frame;

    if (kept->truth) return truth_seek(kept->truth, frame, auditing->error);
    kept->truth = truth_open(&(struct truth_params){.job = auditing->planned, .frame = frame}, auditing->error);
    return kept->truth != NULL;
}

static bool stop(const struct auditing *auditing)
{
    if (*auditing->fault != RENDERER_FAULT_NONE) return false;
    *auditing->fault = RENDERER_FAULT_STOPPED;
    error_set(auditing->error, "the frame was stopped");
    return false;
}

static bool on_progress(void *user, double done)
{
    const struct auditing *auditing = user;
    const struct plan_params *params = auditing->audit->params;

    return !params->on_progress || params->on_progress(params->user, done);
}

static bool on_trace(void *user, const struct pixel *points, size_t count, float *rgba)
{
    const struct auditing *auditing = user;

    return pixel_audit_trace(&auditing->pixels, points, count, rgba, auditing->fault, auditing->error);
}

// The plan's views are in its own quality, not in the one before it.
static bool has_own_views(const struct frame_audit *audit)
{
    return !audit->is_finer && !audit->kept->plan.has_before;
}

static bool audit_against_reference(struct auditing *auditing, const struct audit_verdict *interpolation,
                                    struct audit_result *result)
{
    const struct frame_audit *audit = auditing->audit;
    const struct plan_params *params = audit->params;
    const struct plan_kept *kept = audit->kept;
    const struct plan_view *view = plan_evidence_find(&kept->evidence, audit->frame);
    bool is_pooled = kept->evidence.pool.samples.count > 0 && !audit->is_finer;
    // Frames of a scene in which nothing moves are equal: each draws the same pixels, and every view is its own.
    bool is_constant = scene_is_constant(&params->job->scene);
    struct audit_params compared = {.job = auditing->planned,
                                    .frame = is_constant ? 0 : audit->frame,
                                    .image = audit->image,
                                    .pool = is_pooled ? &kept->evidence.pool : NULL,
                                    .tolerance = params->job->quality.tolerance,
                                    .is_replaceable = audit->is_replaceable,
                                    .on_trace = auditing->is_joined ? on_trace : NULL,
                                    .interpolation = *interpolation,
                                    .on_progress = on_progress,
                                    .user = auditing};

    if (!open_truth(auditing)) {
        *auditing->fault = RENDERER_FAULT_FRAME;
        return false;
    }
    compared.truth = kept->truth;
    // Views have the pilot's size; a frame may be smaller than that in one direction.
    if (view && view->finer.width_px <= params->job->width_px && view->finer.height_px <= params->job->height_px) {
        compared.finer = &view->finer;
        compared.coarser = &view->coarser;
        compared.is_own = (is_constant || view->frame == audit->frame) && has_own_views(audit);
    }
    return audit_frame(&compared, result) || stop(auditing);
}

static bool audit_by_steps(struct auditing *auditing, struct audit_result *result)
{
    const struct frame_audit *audit = auditing->audit;
    const struct plan_params *params = audit->params;
    struct plan_params looking = *params;
    const struct plan_view *view = plan_evidence_find(&audit->kept->evidence, audit->frame);
    struct job small = plan_small_job(params->job, plan_small_scale(params->job, VIEW_PIXELS));
    const struct plan_view size = {.finer = {.width_px = small.width_px, .height_px = small.height_px}};

    if (view && scene_is_constant(&params->job->scene) && has_own_views(audit)) {
        audit_by_halving(params->job, &view->coarser, &view->finer, result);
        result->is_pooled = true;
        return true;
    }
    looking.tells_renders = true;
    return plan_probe_audit(
        &(struct plan_probe){.params = &looking, .frame = audit->frame, .plan = audit->plan, .image = audit->image},
        view ? view : &size, result, auditing->fault, auditing->error);
}

static void add_interpolation(struct audit_result *result, const struct audit_verdict *verdict)
{
    audit_estimate_join(verdict, &result->error, &result->spread);
    result->error95 += verdict->error95;
    result->interpolation_error = verdict->error;
}

bool frame_audit_run(const struct frame_audit *audit, struct audit_result *result, enum renderer_fault *fault,
                     struct error *error)
{
    struct job planned = plan_apply(audit->plan, audit->params->job);
    struct auditing auditing = {.audit = audit, .planned = &planned, .fault = fault, .error = error};
    struct audit_verdict verdict = {0};

    *fault = RENDERER_FAULT_NONE;
    auditing.pixels = (struct pixel_audit){
        .params = audit->params, .planned = &planned, .frame = audit->frame, .image = audit->image};
    // Noise of random paths looks like interpolation: such a picture is compared as it is.
    auditing.is_joined = audit->image->doubts && planned.quality.method != JOB_METHOD_PATHS;
    if (auditing.is_joined && !pixel_audit_measure(&auditing.pixels, &verdict, fault, error)) return false;
    if (!(truth_has_twin(audit->params->job) ? audit_against_reference(&auditing, &verdict, result)
                                             : audit_by_steps(&auditing, result)))
        return false;
    if (auditing.is_joined) add_interpolation(result, &verdict);
    return true;
}
