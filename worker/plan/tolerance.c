// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/tolerance.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/audit/audit.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/plan/plan_evidence.h"
#include "worker/plan/plan_make.h"
#include "worker/plan/plan_segment.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { KEPT_LIMIT = 4 }; // plans

// A segment's plan, and the evidence and the reference that the audits of its frames share.
struct kept_plan {
    int64_t serial, segment; // serial 0: no plan
    uint64_t used;           // grows with every use of any plan: the smallest is the least recently used
    struct plan plan;
    struct plan_evidence evidence;
    struct truth *truth; // owned; NULL until a frame is audited, or without a twin
};

struct tolerance {
    struct renderer *renderer; // borrowed
    struct kept_plan kept[KEPT_LIMIT];
    uint64_t use_count;
    // The last frame, of which the renderer may make copies, if it was within its tolerance; else shown_serial is 0.
    int64_t shown_serial;
    struct tolerance_result shown;
};

struct tolerance *tolerance_create(struct renderer *renderer)
{
    struct tolerance *tolerance = xcalloc(1, sizeof *tolerance);

    tolerance->renderer = renderer;
    return tolerance;
}

static void drop_plan(struct kept_plan *kept)
{
    truth_close(kept->truth);
    plan_evidence_finish(&kept->evidence);
    *kept = (struct kept_plan){0};
}

void tolerance_destroy(struct tolerance *tolerance)
{
    if (!tolerance) return;
    for (int i = 0; i < KEPT_LIMIT; i++)
        drop_plan(&tolerance->kept[i]);
    free(tolerance);
}

static struct kept_plan *find_or_make_plan(struct tolerance *tolerance, const struct tolerance_params *params,
                                           enum renderer_fault *fault, struct error *error)
{
    struct plan_segment segment = plan_segment_of(params->job, params->frame);
    struct kept_plan *oldest = &tolerance->kept[0];

    for (int i = 0; i < KEPT_LIMIT; i++) {
        struct kept_plan *kept = &tolerance->kept[i];

        if (kept->serial == params->serial && kept->segment == segment.index) {
            kept->used = ++tolerance->use_count;
            return kept;
        }
        if (kept->used < oldest->used) oldest = kept;
    }
    drop_plan(oldest);
    tolerance->shown_serial = 0;
    if (params->on_plan) params->on_plan(params->user, false);
    if (!plan_make(&oldest->plan,
                   &(struct plan_params){.renderer = tolerance->renderer,
                                         .job = params->job,
                                         .segment = segment,
                                         .choice = params->choice,
                                         .evidence = &oldest->evidence,
                                         .on_progress = params->on_progress,
                                         .user = params->user},
                   fault, error)) {
        drop_plan(oldest);
        return NULL;
    }
    if (params->on_plan) params->on_plan(params->user, true);
    oldest->serial = params->serial;
    oldest->segment = segment.index;
    oldest->used = ++tolerance->use_count;
    return oldest;
}

// A frame that is rendered once or twice.
struct rendering {
    struct tolerance *tolerance;
    const struct tolerance_params *params;
    struct kept_plan *kept;
    struct tolerance_result *result;
    struct error *error;
    bool is_finer;  // finer than the segment's plan: its audit shares no samples with other frames
    double seconds; // of all renderings so far
};

static bool on_pixel(void *user)
{
    const struct tolerance_params *params = user;

    return !params->on_progress || params->on_progress(params->user, 1.0);
}

static bool open_truth(const struct rendering *rendering, const struct job *planned)
{
    struct kept_plan *kept = rendering->kept;
    int32_t frame = rendering->params->frame;

    if (kept->truth) return truth_seek(kept->truth, frame, rendering->error);
    kept->truth = truth_open(&(struct truth_params){.job = planned, .frame = frame}, rendering->error);
    return kept->truth != NULL;
}

static bool stop(const struct rendering *rendering)
{
    rendering->result->render.fault = RENDERER_FAULT_STOPPED;
    error_set(rendering->error, "the frame was stopped");
    return false;
}

static bool audit_against_reference(const struct rendering *rendering, const struct job *planned)
{
    const struct tolerance_params *params = rendering->params;
    const struct kept_plan *kept = rendering->kept;
    const struct plan_view *view = plan_evidence_find(&kept->evidence, params->frame);
    bool is_pooled = kept->evidence.pool.samples.count > 0 && !rendering->is_finer;
    struct audit_params audit = {.job = planned,
                                 .frame = params->frame,
                                 .image = params->image,
                                 .pool = is_pooled ? &kept->evidence.pool : NULL,
                                 .tolerance = params->job->quality.tolerance,
                                 .budget_s = AUDIT_TIME_SHARE * rendering->seconds,
                                 .on_progress = on_pixel,
                                 .user = (void *)params};

    if (!open_truth(rendering, planned)) {
        rendering->result->render.fault = RENDERER_FAULT_FRAME;
        return false;
    }
    audit.truth = kept->truth;
    // Views have the pilot's size; a frame may be smaller than that in one direction.
    if (view && view->finer.width_px <= planned->width_px && view->finer.height_px <= planned->height_px) {
        audit.finer = &view->finer;
        audit.coarser = &view->coarser;
        audit.is_own = view->frame == params->frame && !rendering->is_finer;
    }
    return audit_frame(&audit, &rendering->result->audit) || stop(rendering);
}

static bool has_promise(const struct scene_density *density)
{
    return density->kind == SCENE_DENSITY_GLSL && density->glsl.lipschitz > 0.0;
}

// Renders the frame small, with one sample. The small size keeps the renderer from copying the next frame from this
// one. `is_bounded` false: the user's code is evaluated even where its lipschitz promises empty space.
static bool render_small(const struct rendering *rendering, const struct plan *plan, const struct image *size,
                         bool is_bounded, struct image *image)
{
    const struct tolerance_params *params = rendering->params;
    struct job job = plan_apply(plan, params->job);
    struct renderer_result result;

    for (size_t i = 0; i < job.scene.medium_count && !is_bounded; ++i)
        if (has_promise(&job.scene.media[i].density)) job.scene.media[i].density.glsl.lipschitz = 0.0;
    job.width_px = size->width_px;
    job.height_px = size->height_px;
    job.quality.samples = 1;
    rendering->tolerance->shown_serial = 0;
    if (!image_init_for_job(image, &job, rendering->error)) return false;
    if (renderer_render(rendering->tolerance->renderer,
                        &(struct renderer_frame){.job = &job,
                                                 .frame = params->frame,
                                                 .image = image,
                                                 .on_progress = params->on_progress,
                                                 .user = params->user},
                        &result, rendering->error))
        return true;
    rendering->result->render.fault = result.fault;
    return false;
}

static bool audit_by_steps(const struct rendering *rendering, const struct plan *plan)
{
    const struct tolerance_params *params = rendering->params;
    const struct plan_view *view = plan_evidence_find(&rendering->kept->evidence, params->frame);
    struct image finer = {0}, coarser = {0};
    struct plan halved = *plan;
    bool ok = view != NULL;

    (void)plan_refine(&halved, params->job, PLAN_HALVING_RUNGS);
    if (ok && scene_is_constant(&params->job->scene) && !rendering->is_finer) {
        audit_by_halving(params->job, &view->coarser, &view->finer, &rendering->result->audit);
        rendering->result->audit.is_pooled = true;
        return true;
    }
    ok = ok && render_small(rendering, plan, &view->finer, true, &coarser) &&
         render_small(rendering, &halved, &view->finer, false, &finer);
    if (ok) audit_by_halving(params->job, &coarser, &finer, &rendering->result->audit);
    image_finish(&finer);
    image_finish(&coarser);
    return ok;
}

// A frame that equals the one before has the same error.
static bool audit(const struct rendering *rendering, const struct plan *plan, const struct job *planned)
{
    struct tolerance *tolerance = rendering->tolerance;
    struct tolerance_result *result = rendering->result;

    if (result->render.is_copy && tolerance->shown_serial == rendering->params->serial) {
        result->audit = tolerance->shown.audit;
        result->audit.seconds = 0.0;
        return true;
    }
    tolerance->shown_serial = 0;
    if (!truth_has_twin(rendering->params->job)) return audit_by_steps(rendering, plan);
    return audit_against_reference(rendering, planned);
}

static bool render_and_audit(struct rendering *rendering, const struct plan *plan)
{
    const struct tolerance_params *params = rendering->params;
    struct tolerance_result *result = rendering->result;
    struct job planned = plan_apply(plan, params->job);

    result->quality = plan->quality;
    if (!renderer_render(rendering->tolerance->renderer,
                         &(struct renderer_frame){.job = &planned,
                                                  .frame = params->frame,
                                                  .image = params->image,
                                                  .on_progress = params->on_progress,
                                                  .user = params->user},
                         &result->render, rendering->error))
        return false;
    rendering->seconds += result->render.seconds;
    result->render.seconds = rendering->seconds;
    if (!audit(rendering, plan, &planned)) return false;
    log_debug("tolerance: frame %d: %s error %.2e, at most %.2e, of %g, by %d pixels in %.3f s", (int)params->frame,
              job_method_name(plan->quality.method), result->audit.error, result->audit.error95,
              params->job->quality.tolerance, result->audit.ray_count, result->audit.seconds);
    return true;
}

// False for NaN.
static bool is_within(const struct rendering *rendering)
{
    return rendering->result->audit.error <= rendering->params->job->quality.tolerance;
}

static void note_shown(struct rendering *rendering)
{
    rendering->tolerance->shown_serial = rendering->params->serial;
    rendering->tolerance->shown = *rendering->result;
}

static bool miss(const struct rendering *rendering)
{
    const struct audit_result *audit = &rendering->result->audit;
    const struct scene *scene = &rendering->params->job->scene;
    bool promises = false;

    for (size_t i = 0; i < scene->medium_count; ++i)
        promises |= has_promise(&scene->media[i].density);
    rendering->result->render.fault = RENDERER_FAULT_MISSED;
    error_set(rendering->error,
              "quality.tolerance: expected an error of at most %g, got %.3g (with confidence below %.3g), and %.3g in "
              "longer steps before%s; %s",
              rendering->params->job->quality.tolerance, audit->error, audit->error95, rendering->result->first_error,
              promises ? " (is a density.lipschitz too low?)" : "", rendering->kept->plan.reason);
    return false;
}

int tolerance_find_retry_rungs(double error, double tolerance)
{
    static const double ORDER = 1.5, GOAL = 0.5;
    static const int classes[] = {3, 5, 8};
    double wanted = 2.0 * log2(error / (GOAL * tolerance)) / ORDER;
    size_t i = 0;

    while (i + 1 < sizeof classes / sizeof *classes && !(wanted <= classes[i]))
        i++;
    return classes[i];
}

static bool render_planned(struct rendering *rendering)
{
    struct tolerance_result *result = rendering->result;
    const struct plan *plan = &rendering->kept->plan;
    struct plan finer = plan_of_frame(plan, rendering->params->job, rendering->params->frame);

    rendering->is_finer = memcmp(&finer.point, &plan->point, sizeof finer.point) != 0;
    memcpy(result->reason, finer.reason, sizeof result->reason);
    if (!render_and_audit(rendering, &finer)) return false;
    result->first_error = result->audit.error;
    if (is_within(rendering)) {
        note_shown(rendering);
        return true;
    }
    if (!plan_refine(&finer, rendering->params->job,
                     tolerance_find_retry_rungs(result->first_error, rendering->params->job->quality.tolerance)))
        return miss(rendering);
    result->is_second = rendering->is_finer = true;
    return render_and_audit(rendering, &finer) && (is_within(rendering) || miss(rendering));
}

bool tolerance_render(struct tolerance *tolerance, const struct tolerance_params *params,
                      struct tolerance_result *result, struct error *error)
{
    struct rendering rendering = {.tolerance = tolerance, .params = params, .result = result, .error = error};

    *result = (struct tolerance_result){.quality = params->job->quality};
    if (params->job->quality.method != JOB_METHOD_AUTO) {
        tolerance->shown_serial = 0;
        return renderer_render(tolerance->renderer,
                               &(struct renderer_frame){.job = params->job,
                                                        .frame = params->frame,
                                                        .image = params->image,
                                                        .on_progress = params->on_progress,
                                                        .user = params->user},
                               &result->render, error);
    }
    rendering.kept = find_or_make_plan(tolerance, params, &result->render.fault, error);
    return rendering.kept && render_planned(&rendering);
}
