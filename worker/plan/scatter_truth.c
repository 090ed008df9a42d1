// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/scatter_truth.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/scene/light_rules.h"
#include "worker/audit/audit_map.h"
#include "worker/audit/truth.h"
#include "worker/picture/audit_result.h"
#include "worker/plan/plan_family.h"
#include "worker/plan/scatter_light.h"

#include <math.h>
#include <stdlib.h>

enum {
    PIXELS = 16 * 12, // of each frame; more where
    LIT = 64,         // fewer than that would make up its light
    PIXELS_MOST = 32 * 24
};

// The accuracy asked of reference/, relative to the tolerance; that of light that is only weighed.
static const double ACCURACY_SHARE = 0.66, ROUGH_ACCURACY = 0.1;
static const double FLOOR_SHARE = 0.2; // of the light's RMS: darker pixels are measured as if they had so much
static const double ALL_PART = 0.9;    // of the time for a frame's light; the rest is for the first order

struct job scatter_truth_first_of(const struct job *job)
{
    struct job first = *job;

    first.scene.orders = 1;
    first.scene.light_count = 0;
    for (size_t i = 0; i < job->scene.light_count; i++)
        if (!light_rules_of(job->scene.lights[i].kind)->has_size)
            first.scene.lights[first.scene.light_count++] = job->scene.lights[i];
    return first;
}

static bool measure_truth(struct scatter_truth *light, const struct job *job, int32_t number,
                          const struct integrate_accuracy *accuracy, struct truth_pixel *pixels)
{
    struct truth *truth =
        truth_open(&(struct truth_params){.job = job, .frame = number, .is_for_plan = true}, light->error);
    size_t count = plan_lattice_count(&light->lattice), measured;

    *light->fault = RENDERER_FAULT_FRAME;
    if (!truth) return false;
    measured = truth_measure_many(truth, &(struct truth_many){.points = light->lattice.pixels,
                                                              .pixels = pixels,
                                                              .count = count,
                                                              .accuracy = accuracy,
                                                              .on_progress = scatter_progress_on_pixel,
                                                              .user = &light->progress,
                                                              .done = &light->progress.done});
    truth_close(truth);
    if (measured == count) return true;
    *light->fault = RENDERER_FAULT_STOPPED;
    error_set(light->error, "the frame was stopped");
    return false;
}

// A few paths tell how bright the pixels are.
static const struct integrate_accuracy LEAST_ACCURACY = {.relative = 10.0, .floor = AUDIT_BLACK};

// Where few pixels have most of the light, errors would be known by few: the lattice becomes finer.
static bool choose_lattice(struct scatter_truth *light)
{
    const struct plan_segment *segment = &light->params->segment;
    struct truth_pixel *pixels;
    double lit = LIT;
    bool ok;

    plan_lattice_init(&light->lattice, light->params->job, PIXELS);
    pixels = xcalloc(plan_lattice_count(&light->lattice), sizeof *pixels);
    ok = measure_truth(light, &light->job, segment->pilot[segment->pilot_count / 2], &LEAST_ACCURACY, pixels);
    if (ok) lit = scatter_light_count(pixels, plan_lattice_count(&light->lattice));
    free(pixels);
    if (lit >= LIT) return ok;
    plan_lattice_finish(&light->lattice);
    plan_lattice_init(&light->lattice, light->params->job, (int)fmin(PIXELS * LIT / fmax(lit, 1.0), PIXELS_MOST));
    return true;
}

// Paths of pixels without grids of lights have noise alone, which two pictures tell by themselves: what they are
// compared with is only weighed.
static bool may_have_grids(const struct job *job)
{
    struct plan_scene scene;

    plan_scene_init(&scene, job);
    for (size_t i = 0; i < plan_family_count; i++)
        if (plan_families[i].axis_count > 1 && plan_family_serves(&plan_families[i], &scene)) return true;
    return false;
}

// `first` is the job of the first order, whose light is measured in `alone`.
static bool measure_light(struct scatter_truth *light, const struct job *first, struct scatter_frame *frame,
                          struct truth_pixel *alone)
{
    double wanted = ACCURACY_SHARE * light->params->job->quality.tolerance;
    struct integrate_accuracy accuracy = {.relative =
                                              may_have_grids(&light->job) ? wanted : fmax(wanted, ROUGH_ACCURACY)};
    size_t count = plan_lattice_count(&light->lattice);
    double share, each = 1.0 / light->params->segment.pilot_count;

    // A few paths tell how bright the frame is, and so how exact its dark pixels have to be.
    if (!measure_truth(light, &light->job, frame->number, &LEAST_ACCURACY, frame->truth)) return false;
    accuracy.floor = fmax(FLOOR_SHARE * sqrt(scatter_light_square(frame->truth, count)), AUDIT_BLACK);
    scatter_progress_begin_light(&light->progress, ALL_PART * each, frame->truth, count);
    if (!measure_truth(light, &light->job, frame->number, &accuracy, frame->truth)) return false;
    scatter_progress_begin_light(&light->progress, (1.0 - ALL_PART) * each, frame->truth, count);
    if (!measure_truth(light, first, frame->number,
                       &(struct integrate_accuracy){.relative = ROUGH_ACCURACY, .floor = accuracy.floor}, alone))
        return false;
    frame->light = scatter_light_square(frame->truth, count);
    share = frame->light > 0.0 ? sqrt(scatter_light_square(alone, count) / frame->light) : 1.0;
    light->first_share = fmax(light->first_share, share);
    return true;
}

bool scatter_truth_measure(struct scatter_truth *light, const struct plan_params *params, enum renderer_fault *fault,
                           struct error *error)
{
    const struct plan_segment *segment = &params->segment;
    struct job first;
    struct truth_pixel *alone;
    bool ok = true;

    *light = (struct scatter_truth){
        .params = params, .job = *params->job, .progress.params = params, .fault = fault, .error = error};
    light->job.quality.samples = 1;
    first = scatter_truth_first_of(&light->job);
    if (!choose_lattice(light)) return false;
    alone = xcalloc(plan_lattice_count(&light->lattice), sizeof *alone);
    for (int i = 0; i < segment->pilot_count && ok; i++) {
        struct scatter_frame *frame = &light->frames[light->frame_count++];

        frame->number = segment->pilot[i];
        frame->truth = xcalloc(plan_lattice_count(&light->lattice), sizeof *frame->truth);
        ok = measure_light(light, &first, frame, alone);
    }
    free(alone);
    return ok;
}

void scatter_truth_finish(struct scatter_truth *light)
{
    for (int i = 0; i < light->frame_count; i++)
        free(light->frames[i].truth);
    plan_lattice_finish(&light->lattice);
}
