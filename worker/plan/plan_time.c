// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_time.h"

#include "core/base/clock.h"
#include "core/base/error.h"
#include "worker/picture/image.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/plan_progress.h"
#include "worker/plan/plan_segment.h"
#include "worker/plan/plan_small.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

// All set by hand; bench/predictions compares predicted with measured seconds.
enum {
    PIXELS = 480 * 270, // of the larger renders, at most
    SMALLER = 2,        // the smaller renders' sides are this part of the larger ones'
    FRAMES = 5,         // of the segment that are timed
    REPEATS = 3
};
static const double LONG_S = 2.0; // a timing that takes longer is not repeated
// Where one of the larger renders would take longer, as random paths are foretold to, none is made.
static const double FORETOLD_S = 5.0;

struct timing {
    const struct plan_params *params;
    const struct plan *plan;
    enum renderer_fault *fault;
    struct error *error;
    double scale;     // of the larger renders' sides
    int repeat_count; // of each timing, of which the median counts
    bool by_processor;
    bool keeps_grids; // light grids stay from frame to frame
    double shown;     // share of the segment's frames that are rendered; the others are copies of the frame before
    double parallel;  // processor seconds per second, in the least disturbed render
    int render_count; // so far
};

// Which pixels are traced depends on the size, so that frames with interpolated pixels are timed as they are.
static bool is_sparse(const struct plan *plan)
{
    return plan->pixels.stride > 0;
}

static double pixels_at(const struct timing *timing, double scale)
{
    struct job small = plan_small_job(timing->params->job, scale);

    return (double)small.width_px * small.height_px;
}

static int count_frames(const struct timing *timing)
{
    return timing->params->segment.count < FRAMES ? (int)timing->params->segment.count : FRAMES;
}

static void note_render(struct timing *timing)
{
    // Each timing of all frames also finds the fixed part by two renders; two come before them all.
    double most = 2.0 + timing->repeat_count * (count_frames(timing) + 2.0);

    plan_progress_note(timing->params, PLAN_STAGE_TIMING, ++timing->render_count / most);
}

static bool render(struct timing *timing, int32_t frame, double scale, struct renderer_result *result)
{
    struct job planned = plan_apply(timing->plan, timing->params->job), small = plan_small_job(&planned, scale);
    struct image image = {0};
    bool ok = plan_small_render(timing->params, is_sparse(timing->plan) ? &planned : &small, frame, &image, result,
                                timing->error);

    if (!ok) *timing->fault = result->fault;
    image_finish(&image);
    note_render(timing);
    return ok;
}

// In software, processor time counts: other programs on the machine hardly change it.
static bool time_render(struct timing *timing, int32_t frame, double scale, double *seconds)
{
    double processor_s = clock_read_s(CLOCK_PROCESS_CPUTIME_ID), wall_s = clock_read_s(CLOCK_MONOTONIC);
    struct renderer_result result;

    if (!render(timing, frame, scale, &result)) return false;
    processor_s = clock_read_s(CLOCK_PROCESS_CPUTIME_ID) - processor_s;
    wall_s = clock_read_s(CLOCK_MONOTONIC) - wall_s;
    if (wall_s > 0.0) timing->parallel = fmax(timing->parallel, processor_s / wall_s);
    *seconds = timing->by_processor ? processor_s : result.seconds;
    return true;
}

// The seconds of a frame that do not depend on its number of pixels.
struct fixed {
    double frame_s; // of every render
    double grids_s; // of filling light grids, which a second render of the same frame finds filled
};

static bool find_fixed(struct timing *timing, int32_t frame, double first_s, struct fixed *fixed)
{
    double small = timing->scale / SMALLER, small_s, again_s, pixel_s;

    if (!time_render(timing, frame, small, &small_s) || !time_render(timing, frame, timing->scale, &again_s))
        return false;
    pixel_s = fmax(again_s - small_s, 0.0) / (pixels_at(timing, timing->scale) - pixels_at(timing, small));
    fixed->frame_s = fmax(again_s - pixel_s * pixels_at(timing, timing->scale), 0.0);
    fixed->grids_s = fmax(first_s - again_s, 0.0);
    return true;
}

// The mean seconds of the segment's frames at the job's size, from a few of its frames by the trapezoidal rule.
static bool time_frames(struct timing *timing, double *seconds)
{
    const struct plan_segment *segment = &timing->params->segment;
    const struct job *job = timing->params->job;
    double ratio = (double)job->width_px * job->height_px / pixels_at(timing, timing->scale), sum = 0.0;
    int count = count_frames(timing);
    struct fixed fixed = {0};

    for (int i = 0; i < count; i++) {
        int64_t index = count > 1 ? segment->first + i * (segment->count - 1) / (count - 1) : segment->first;
        int32_t frame = frame_range_at(&job->frames, index);
        bool is_end = i == 0 || i == count - 1;
        double frame_s;

        if (!timing->keeps_grids) renderer_forget(timing->params->renderer);
        if (!time_render(timing, frame, timing->scale, &frame_s)) return false;
        if (i == 0 && ratio > 1.0 && !find_fixed(timing, frame, frame_s, &fixed)) return false;
        sum += count > 1 ? frame_s * (is_end ? 0.5 : 1.0) / (count - 1) : frame_s;
    }
    *seconds = fmax(sum - fixed.frame_s - fixed.grids_s, 0.0) * ratio + fixed.frame_s + fixed.grids_s;
    return true;
}

// Links programs and reads files, and finds whether frames are copies or keep the light grids of the frame before.
static bool begin(struct timing *timing)
{
    const struct plan_segment *segment = &timing->params->segment;
    struct renderer_result result;

    timing->shown = 1.0;
    renderer_forget(timing->params->renderer);
    if (!render(timing, frame_range_at(&timing->params->job->frames, segment->first), timing->scale, &result))
        return false;
    if (segment->count == 1) return true;
    if (!render(timing, frame_range_at(&timing->params->job->frames, segment->first + 1), timing->scale, &result))
        return false;
    timing->keeps_grids = result.cache_fills == 0 && !result.is_copy;
    if (result.is_copy) timing->shown = 1.0 / (double)segment->count;
    return true;
}

static int compare(const void *a, const void *b)
{
    double left = *(const double *)a, right = *(const double *)b;

    return left < right ? -1 : left > right;
}

bool plan_time_predict(struct plan *plan, const struct plan_params *params, enum renderer_fault *fault,
                       struct error *error)
{
    const struct job *job = params->job;
    struct timing timing = {.params = params,
                            .plan = plan,
                            .fault = fault,
                            .error = error,
                            .scale = is_sparse(plan) ? 1.0 : plan_small_scale(job, PIXELS),
                            .repeat_count = is_sparse(plan) ? 1 : REPEATS,
                            .by_processor = renderer_is_software(params->renderer)};
    double seconds[REPEATS];
    int count = 0;

    if (plan->predicted_s * pixels_at(&timing, timing.scale) > FORETOLD_S * job->width_px * job->height_px) {
        double pictures = plan_segment_pictures(job, &params->segment) / (double)params->segment.count;

        plan->predicted_s *= pictures * plan->work_ratio;
        plan->predicted_processor_s *= pictures * plan->work_ratio;
        return true;
    }
    if (!begin(&timing)) return false;
    while (count < timing.repeat_count) {
        if (!time_frames(&timing, &seconds[count])) return false;
        if (seconds[count++] > LONG_S) break;
    }
    qsort(seconds, (size_t)count, sizeof *seconds, compare);
    plan->predicted_s = seconds[count / 2] * timing.shown * plan->work_ratio;
    if (!timing.by_processor) return true;
    plan->predicted_processor_s = plan->predicted_s;
    if (timing.parallel > 0.0) plan->predicted_s /= timing.parallel;
    return true;
}
