// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_pixels.h"

#include "core/base/log.h"
#include "core/job/job_layers.h"
#include "core/job/job_pixels.h"
#include "core/job/step_check.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/plan/pixel_audit.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_family.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/plan_scatter.h"
#include "worker/plan/plan_small.h"

#include <math.h>

enum {
    SIDE_MIN = 128, // px: small pictures are mostly edges
    TRIES = 2,
    LONG = 8,        // frames
    STRIDE_FINE = 4, // px: a sixteenth of the pixels is traced, which in these scenes are hardly more
    STRIDE_LEAST = 2,
    STRIDE_MOST = 64,
    TRIAL_PART = 16, // of a plan's paths: those of its trial
    TRIAL_LEAST = 64,
    SIDE_STRIDE = 1920 // px: the longer side for which strides are meant; double strides from the double of it on
};

// Set by hand; bench/whole_frames shows what follows from them.
static const double AIM = 0.65;                                   // of the tolerance: the error of all parts together
static const double SHARE_LEAST = 0.3, SHARE_MOST = 0.5;          // of the tolerance: that of interpolation
static const double COARSER_MOST = 4.0, FINER_LEAST = 1.0 / 16.0; // than a threshold of the tolerance
// The same in pictures of fewer than SMALL pixels, where errors rise faster than the threshold: `noise` of 640x360 has
// six times the error at four times the threshold, of 1920x1080 less than twice.
static const double COARSER_SMALL = 2.0, SMALL = 1e6;
static const double CAUTION = 0.8;     // of the share: errors may rise faster than the threshold
static const double GPU_WORK = 5000.0; // evaluations a pixel; not measured on a GPU
static const double TRACED_MOST = 0.6; // share of the pixels; above it all are traced
// Random paths of a frame with which few pixels of many paths repay their trial and its linking.
static const double PATHS_LEAST = 1e7;
static const double NOISE_SHARE = 0.6; // of the tolerance: that of a frame whose pixels are interpolated
static const double UNEXPLAINED = 1.5; // times its noise: an error
// Above it a finer threshold is not tried; in segments of LONG frames and more, which repay it, not above TRACED_LONG.
static const double TRACED_AGAIN = 0.35, TRACED_LONG = 0.5;

static bool is_worthwhile(const struct job *job, const struct job_quality *quality)
{
    const struct scene *scene = &job->scene;
    const struct job seen = job_layers_seen(job);
    bool is_still = scene_is_constant(scene);
    // Each level would fill the grids of each moment anew.
    bool moves_grids = (quality->method == JOB_METHOD_CACHED || quality->light_grid > 0) && quality->samples > 1 &&
                       !is_still && scene->camera.shutter > 0.0;

    if (job->width_px < SIDE_MIN || job->height_px < SIDE_MIN || moves_grids) return false;
    if (job_pixels_obstacle(scene, quality->method)) return false;
    if (quality->method == JOB_METHOD_PATHS)
        return truth_has_twin(job) && step_has_end(&seen) &&
               (double)job->width_px * job->height_px * quality->samples * quality->paths >= PATHS_LEAST;
    // Frames that are all the same are copied.
    return !is_still || frame_range_count(&job->frames) == 1;
}

// Interpolation and reading lists back take tens of milliseconds of a processor in a frame of two million pixels.
static bool is_dear(const struct plan_params *params, const struct plan *plan)
{
    return renderer_is_software(params->renderer) || plan->work > GPU_WORK;
}

// Glints and texture may be small, and no guard knows where they are. A larger picture of a scene shows no more of
// them, so that its stride is about the same part of it.
static int find_stride(const struct job *job)
{
    int stride = job->scene.object_count > 0 ? STRIDE_FINE : JOB_STRIDE_DEFAULT;
    int side = job->width_px > job->height_px ? job->width_px : job->height_px;

    for (; side >= 2 * SIDE_STRIDE && stride < STRIDE_MOST; side /= 2)
        stride *= 2;
    return stride;
}

static double round_digits(double value)
{
    double unit = pow(10.0, floor(log10(value)) - 1.0);

    return floor(value / unit) * unit;
}

// Renders the segment's middle frame by the plan. False where that cannot be done.
static bool render_middle(const struct plan *plan, const struct plan_params *params, enum renderer_stream stream,
                          struct image *image, struct renderer_result *result, struct error *error)
{
    const struct plan_segment *segment = &params->segment;
    struct job planned = plan_apply(plan, params->job);
    int32_t frame = frame_range_at(&params->job->frames, segment->first + segment->count / 2);

    *result = (struct renderer_result){.fault = RENDERER_FAULT_FRAME};
    return image_init_for_job(image, &planned, error) &&
           renderer_render(params->renderer,
                           &(struct renderer_frame){.job = &planned,
                                                    .frame = frame,
                                                    .stream = stream,
                                                    .image = image,
                                                    .on_progress = plan_small_on_tile,
                                                    .user = (void *)params},
                           result, error);
}

// Renders it and measures what interpolation adds. `traced` is 1 where that cannot be done.
static bool measure(struct plan *plan, const struct plan_params *params, struct audit_verdict *verdict,
                    enum renderer_fault *fault, struct error *error)
{
    const struct plan_segment *segment = &params->segment;
    struct job planned = plan_apply(plan, params->job);
    struct image image = {0};
    struct renderer_result result;
    struct pixel_audit audit = {.params = params,
                                .planned = &planned,
                                .frame = frame_range_at(&params->job->frames, segment->first + segment->count / 2),
                                .image = &image};
    bool ok = render_middle(plan, params, RENDERER_STREAM_PICTURE, &image, &result, error);

    *fault = result.fault;
    *verdict = (struct audit_verdict){.error = INFINITY};
    ok = ok && pixel_audit_measure(&audit, verdict, fault, error);
    image_finish(&image);
    plan->predicted_traced = ok ? result.traced : 1.0;
    return ok || !renderer_fault_is_final(*fault);
}

static void trace_all(struct plan *plan)
{
    plan->pixels = (struct job_pixels){0};
    plan->predicted_traced = 1.0;
}

// The threshold at which interpolation adds `share` of the tolerance, if errors are in proportion to thresholds.
static double find_threshold(const struct plan *plan, double share, double tolerance, double error)
{
    double wanted = CAUTION * share * tolerance / fmax(error, 1e-12) * plan->pixels.threshold;

    return fmin(round_digits(fmin(fmax(wanted, FINER_LEAST * tolerance), COARSER_MOST * tolerance)), 1.0);
}

static double find_coarsest(const struct job *job)
{
    bool is_small = (double)job->width_px * job->height_px < SMALL;

    return (is_small ? COARSER_SMALL : COARSER_MOST) * job->quality.tolerance;
}

// Fewer pixels are traced then: about by the root of the thresholds, as measured at 1920x1080.
static void coarsen(struct plan *plan, double threshold)
{
    double least = 1.0 / (plan->pixels.stride * plan->pixels.stride);

    if (threshold <= plan->pixels.threshold) return;
    plan->predicted_traced = fmax(plan->predicted_traced * sqrt(plan->pixels.threshold / threshold), least);
    plan->pixels.threshold = threshold;
}

// So many paths of a pixel that the noise is what the plan aims at, where `paths` have `noise`.
static void set_paths(struct plan *plan, const struct job *job, int paths, double noise)
{
    double wanted = paths * pow(noise / (NOISE_SHARE * job->quality.tolerance), 2.0);
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    struct plan_scene scene;
    int count;

    plan_scene_init(&scene, job);
    count = plan_family_axes(&plan_families[plan->family], &scene, axes);
    for (int i = 0; i < count; i++)
        if (axes[i] == PLAN_AXIS_PIXEL_PATHS)
            plan->point.rungs[i] = (int)fmin(fmax(ceil(2.0 * log2(wanted)), 0.0), plan_axis_last_rung(axes[i], &scene));
    plan->quality = plan_family_quality(&plan_families[plan->family], &scene, &plan->point);
    plan->work = plan_family_work(&scene, &plan->quality);
    plan->paths_square = noise * noise * paths / plan->quality.paths;
    plan->predicted_error = sqrt(plan->paths_square);
    plan_scatter_describe_paths(plan);
}

// A trial of few paths tells how many pixels are traced, and the noise of all of these: more than the plan's own few
// pixels do.
static bool choose_of_paths(struct plan *plan, const struct plan_params *params, enum renderer_fault *fault,
                            struct error *error)
{
    struct plan trial = *plan;
    struct image image = {0};
    struct renderer_result result;
    double paths = plan->quality.paths, pace;
    bool ok;

    trial.quality.paths = (int)fmax(paths / TRIAL_PART, fmin(paths, TRIAL_LEAST));
    ok = render_middle(&trial, params, RENDERER_STREAM_PLAN, &image, &result, error);
    *fault = result.fault;
    image_finish(&image);
    if (!ok || result.traced > TRACED_MOST) {
        trace_all(plan);
        return ok || !renderer_fault_is_final(*fault);
    }
    plan->predicted_traced = result.traced;
    if (result.noise > 0.0) set_paths(plan, params->job, trial.quality.paths, result.noise);
    pace = result.traced * plan->quality.paths / paths;
    log_debug("plan: pixels: %d paths of %.1f %% have a noise of %.2e: %d", trial.quality.paths, 100.0 * result.traced,
              result.noise, plan->quality.paths);
    plan->predicted_s *= pace;
    plan->predicted_processor_s *= pace;
    return true;
}

bool plan_pixels_choose(struct plan *plan, const struct plan_params *params, enum renderer_fault *fault,
                        struct error *error)
{
    double tolerance = params->job->quality.tolerance, settings = plan->predicted_error / tolerance;
    double share = fmin(fmax(sqrt(fmax(AIM * AIM - settings * settings, 0.0)), SHARE_LEAST), SHARE_MOST);

    *fault = RENDERER_FAULT_NONE;
    trace_all(plan);
    if (params->choice != PLAN_CHOICE_CHEAPEST || !is_worthwhile(params->job, &plan->quality) || !is_dear(params, plan))
        return true;
    plan->pixels = (struct job_pixels){.stride = find_stride(params->job), .threshold = tolerance};
    if (plan->quality.method == JOB_METHOD_PATHS) return choose_of_paths(plan, params, fault, error);
    for (int tried = 0; tried < TRIES; tried++) {
        struct audit_verdict verdict;

        if (!measure(plan, params, &verdict, fault, error)) return false;
        log_debug("plan: pixels: threshold %g traces %.1f %%, adds %.2e, at most %.2e", plan->pixels.threshold,
                  100.0 * plan->predicted_traced, verdict.error, verdict.error95);
        if (plan->predicted_traced > TRACED_MOST) break;
        if (verdict.error <= share * tolerance) {
            coarsen(plan, fmin(find_threshold(plan, share, tolerance, verdict.error), find_coarsest(params->job)));
            plan->predicted_error = hypot(plan->predicted_error, verdict.error);
            return true;
        }
        if (plan->predicted_traced > (params->segment.count < LONG ? TRACED_AGAIN : TRACED_LONG)) break;
        plan->pixels.threshold = find_threshold(plan, share, tolerance, verdict.error);
    }
    trace_all(plan);
    return true;
}

bool plan_pixels_refine_paths(struct plan *plan, double noise, double error)
{
    if (plan->quality.method != JOB_METHOD_PATHS || plan->pixels.stride == 0 || error <= UNEXPLAINED * noise)
        return false;
    plan->pixels.threshold *= 0.5;
    plan->pixels.stride /= 2;
    if (plan->pixels.stride < STRIDE_LEAST) trace_all(plan);
    return true;
}

void plan_pixels_refine(struct plan *plan, double interpolation_error, double tolerance)
{
    double threshold = find_threshold(plan, SHARE_LEAST, tolerance, interpolation_error);

    plan->pixels.threshold = fmin(threshold, 0.5 * plan->pixels.threshold);
    if (plan->pixels.threshold <= FINER_LEAST * tolerance) trace_all(plan);
}
