#include "worker/plan_time.h"

#include "core/error.h"
#include "worker/image.h"
#include "worker/plan.h"

#include <math.h>

enum { PIXELS = 480 * 270, SMALLER = 2 }; // of the larger renders, at most; a side of the smaller ones is a part

struct timing {
    const struct plan_params *params;
    const struct plan *plan;
    enum renderer_fault *fault;
    struct error *error;
    double scale; // of the job's sides
};

static int scaled(int size_px, double scale)
{
    return (int)fmax(1.0, round(scale * size_px));
}

static double pixels_at(const struct timing *timing, double scale)
{
    const struct job *job = timing->params->job;

    return (double)scaled(job->width_px, scale) * scaled(job->height_px, scale);
}

static bool on_tile(void *user, double done)
{
    const struct plan_params *params = user;

    (void)done;
    return !params->on_progress || params->on_progress(params->user, 0.0);
}

static bool render(const struct timing *timing, int32_t frame, double scale, double *seconds)
{
    struct job job = plan_apply(timing->plan, timing->params->job);
    struct renderer_result result = {.fault = RENDERER_FAULT_JOB};
    struct image image = {0};
    bool ok;

    job.width_px = scaled(job.width_px, scale);
    job.height_px = scaled(job.height_px, scale);
    ok = image_init(&image, job.width_px, job.height_px, job.output.has_depth, job.output.has_transmittance,
                    timing->error) &&
         renderer_render(timing->params->renderer, &job, frame, &image, on_tile, (void *)timing->params, &result,
                         timing->error);
    if (!ok) *timing->fault = result.fault;
    *seconds = result.seconds;
    image_finish(&image);
    return ok;
}

// What a frame takes whatever its size, pixels apart: of a frame that was just rendered its grids are there.
struct fixed {
    double frame_s; // each time
    double grids_s; // once the frame is another
};

static bool find_fixed(const struct timing *timing, int32_t frame, double first_s, struct fixed *fixed)
{
    double small = timing->scale / SMALLER, small_s, again_s, pixel_s;

    if (!render(timing, frame, small, &small_s) || !render(timing, frame, timing->scale, &again_s)) return false;
    pixel_s = fmax(again_s - small_s, 0.0) / (pixels_at(timing, timing->scale) - pixels_at(timing, small));
    fixed->frame_s = fmax(again_s - pixel_s * pixels_at(timing, timing->scale), 0.0);
    fixed->grids_s = fmax(first_s - again_s, 0.0);
    return true;
}

bool plan_time_predict(struct plan *plan, const struct plan_params *params, enum renderer_fault *fault,
                       struct error *error)
{
    const struct job *job = params->job;
    const struct plan_segment *segment = &params->segment;
    double all = (double)job->width_px * job->height_px;
    struct timing timing = {params, plan, fault, error, fmin(1.0, sqrt(PIXELS / all))};
    double warm_s, sum = 0.0, ratio = all / pixels_at(&timing, timing.scale);
    struct fixed fixed = {0};
    bool is_whole = ratio <= 1.0;

    // The first render links programs and reads files.
    if (!render(&timing, segment->pilot[segment->pilot_count - 1], timing.scale, &warm_s)) return false;
    for (int i = 0; i < segment->pilot_count; i++) {
        double seconds;

        if (!render(&timing, segment->pilot[i], timing.scale, &seconds)) return false;
        if (i == 0 && !is_whole && !find_fixed(&timing, segment->pilot[i], seconds, &fixed)) return false;
        sum += seconds;
    }
    sum /= segment->pilot_count;
    plan->predicted_s = fmax(sum - fixed.frame_s - fixed.grids_s, 0.0) * ratio + fixed.frame_s + fixed.grids_s;
    return true;
}
