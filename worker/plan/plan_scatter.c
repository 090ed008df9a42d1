// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_scatter.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/scene/light_rules.h"
#include "worker/audit/audit_map.h"
#include "worker/audit/truth.h"
#include "worker/picture/audit_result.h"
#include "worker/picture/image.h"
#include "worker/plan/plan_family.h"
#include "worker/plan/plan_lattice.h"
#include "worker/plan/plan_small.h"
#include "worker/plan/scatter_search.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    PIXELS = 16 * 12,   // of each frame
    LIGHT_GRID_RUNG = 6 // of paths: 64 cells, whose error is a few thousandths of the light
};

// Shares of the tolerance, set by hand: the error of the whole plan, and the part of the first order in it.
static const double SHARE = 0.65, FIRST_SHARE = 0.4;
static const double FIRST_MOST = 0.5; // the largest tolerance of a job
// The accuracy asked of reference/, relative to the tolerance; that of light that is only weighed.
static const double ACCURACY_SHARE = 0.66, ROUGH_ACCURACY = 0.1;
static const double FLOOR_SHARE = 0.2; // of the light's RMS: darker pixels are measured as if they had so much
static const double PATHS_MOST = 6e6;  // that the search may trace: some seconds of a processor

struct frame {
    int32_t number;
    struct truth_pixel truth[PIXELS];
    double light; // mean square
};

struct plan_scatter {
    const struct plan_params *params; // borrowed
    struct job job;                   // a shallow copy, with one sample
    struct plan_lattice lattice;
    struct frame frames[PLAN_PILOT_LIMIT];
    int frame_count;
    double first_share; // RMS of the first order over that of all
    int worst;          // the frame that the search measures
    struct plan *plan;  // that is completed
    size_t paths_family;
    enum renderer_fault fault;
    struct error error;
};

static size_t pixel_count(const struct plan_scatter *scatter)
{
    return plan_lattice_count(&scatter->lattice);
}

static struct job first_of(const struct job *job)
{
    struct job first = *job;

    first.scene.orders = 1;
    first.scene.light_count = 0;
    for (size_t i = 0; i < job->scene.light_count; i++)
        if (!light_rules_of(job->scene.lights[i].kind)->has_size)
            first.scene.lights[first.scene.light_count++] = job->scene.lights[i];
    return first;
}

// Mean square of the light, or its product of halves.
static double mean_square(const struct truth_pixel *pixels, size_t count)
{
    double sum = 0.0;

    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            sum += pixels[i].rgb[c] * pixels[i].rgb[c] - pixels[i].half[c] * pixels[i].half[c];
    return fmax(sum / (3.0 * (double)count), 0.0);
}

static bool measure_truth(struct plan_scatter *scatter, const struct job *job, int32_t number,
                          const struct integrate_accuracy *accuracy, struct truth_pixel *pixels)
{
    struct truth *truth =
        truth_open(&(struct truth_params){.job = job, .frame = number, .is_for_plan = true}, &scatter->error);
    size_t count = pixel_count(scatter), measured;

    scatter->fault = RENDERER_FAULT_FRAME;
    if (!truth) return false;
    measured = truth_measure_many(truth, &(struct truth_many){.points = scatter->lattice.pixels,
                                                              .pixels = pixels,
                                                              .count = count,
                                                              .accuracy = accuracy,
                                                              .on_progress = plan_small_on_pixel,
                                                              .user = (void *)scatter->params});
    truth_close(truth);
    if (measured == count) return true;
    scatter->fault = RENDERER_FAULT_STOPPED;
    error_set(&scatter->error, "the frame was stopped");
    return false;
}

static bool measure_all(struct plan_scatter *scatter)
{
    const struct plan_segment *segment = &scatter->params->segment;
    struct job first = first_of(&scatter->job);
    const struct integrate_accuracy least = {.relative = 10.0, .floor = AUDIT_BLACK};
    struct truth_pixel alone[PIXELS];
    size_t count = pixel_count(scatter);
    double most = 0.0;

    for (int i = 0; i < segment->pilot_count; i++) {
        struct frame *frame = &scatter->frames[scatter->frame_count++];
        struct integrate_accuracy accuracy = {.relative = ACCURACY_SHARE * scatter->params->job->quality.tolerance};
        double share;

        frame->number = segment->pilot[i];
        // A few paths tell how bright the frame is, and so how exact its dark pixels have to be.
        if (!measure_truth(scatter, &scatter->job, frame->number, &least, frame->truth)) return false;
        accuracy.floor = fmax(FLOOR_SHARE * sqrt(mean_square(frame->truth, count)), AUDIT_BLACK);
        if (!measure_truth(scatter, &scatter->job, frame->number, &accuracy, frame->truth) ||
            !measure_truth(scatter, &first, frame->number,
                           &(struct integrate_accuracy){.relative = ROUGH_ACCURACY, .floor = accuracy.floor}, alone))
            return false;
        frame->light = mean_square(frame->truth, count);
        share = frame->light > 0.0 ? sqrt(mean_square(alone, count) / frame->light) : 1.0;
        most = fmax(most, share);
    }
    scatter->first_share = most;
    return true;
}

struct plan_scatter *plan_scatter_create(const struct plan_params *params, enum renderer_fault *fault,
                                         struct error *error)
{
    struct plan_scatter *scatter = xcalloc(1, sizeof *scatter);

    scatter->params = params;
    scatter->job = *params->job;
    scatter->job.quality.samples = 1;
    plan_lattice_init(&scatter->lattice, params->job, PIXELS);
    *fault = RENDERER_FAULT_NONE;
    if (measure_all(scatter)) return scatter;
    *fault = scatter->fault;
    if (error) *error = scatter->error;
    plan_scatter_destroy(scatter);
    return NULL;
}

void plan_scatter_destroy(struct plan_scatter *scatter)
{
    if (!scatter) return;
    plan_lattice_finish(&scatter->lattice);
    free(scatter);
}

struct job plan_scatter_first_job(const struct plan_scatter *scatter)
{
    struct job first = first_of(scatter->params->job);
    double tolerance = scatter->params->job->quality.tolerance;

    first.quality.tolerance = fmin(FIRST_SHARE * tolerance / fmax(scatter->first_share, 1e-3), FIRST_MOST);
    return first;
}

// Writes a setting of the scattered light into the plan.
static void set_point(const struct plan_scatter *scatter, struct plan *plan, int grid_rung, int path_rung)
{
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    struct plan_scene scene;
    int count;

    plan_scene_init(&scene, scatter->params->job);
    if (grid_rung == SCATTER_PIXELS) {
        plan->family = scatter->paths_family;
        plan->point = (struct plan_point){{0}};
    }
    count = plan_family_axes(&plan_families[plan->family], &scene, axes);
    for (int i = 0; i < count; i++) {
        if (axes[i] == PLAN_AXIS_SCATTER_GRID) plan->point.rungs[i] = grid_rung;
        if (axes[i] == PLAN_AXIS_LIGHT_GRID && grid_rung == SCATTER_PIXELS) plan->point.rungs[i] = LIGHT_GRID_RUNG;
        if (axes[i] == PLAN_AXIS_NODE_PATHS || axes[i] == PLAN_AXIS_PIXEL_PATHS) plan->point.rungs[i] = path_rung;
    }
    plan->quality = plan_family_quality(&plan_families[plan->family], &scene, &plan->point);
}

// The product of the differences to both halves of the light, so that its noise counts nothing.
static double square_error(const struct plan_scatter *scatter, const struct frame *frame, const struct image *image)
{
    size_t count = pixel_count(scatter);
    double sum = 0.0;

    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < 3; c++) {
            double off = image->rgba[4 * i + c] - frame->truth[i].rgb[c], half = frame->truth[i].half[c];

            sum += off * off - half * half;
        }
    sum /= 3.0 * (double)count;
    return frame->light > AUDIT_BLACK * AUDIT_BLACK ? sum / frame->light : sum;
}

static bool measure_frame(struct plan_scatter *scatter, const struct plan *plan, int index, double *square)
{
    struct frame *frame = &scatter->frames[index];
    struct job planned = scatter->job;
    struct renderer_result result;
    struct image image = {0};
    bool ok;

    planned.quality = plan->quality;
    planned.quality.samples = 1;
    ok = plan_lattice_render(&scatter->lattice, scatter->params, &planned, frame->number, &image, &result,
                             &scatter->error);
    scatter->fault = result.fault;
    *square = ok ? square_error(scatter, frame, &image) : INFINITY;
    image_finish(&image);
    return ok;
}

static bool measure(void *user, int grid_rung, int path_rung, double *square)
{
    struct plan_scatter *scatter = user;
    struct plan tried = *scatter->plan;

    set_point(scatter, &tried, grid_rung, path_rung);
    if (!measure_frame(scatter, &tried, scatter->worst, square) && renderer_fault_is_final(scatter->fault))
        return false;
    log_debug("plan: scattered light by %d cells, %d paths: error %.2e", tried.quality.scatter_grid,
              tried.quality.paths, sqrt(fmax(*square, 0.0)));
    return true;
}

// The frame with the largest error of the cheapest setting is the one that the search measures.
static bool find_worst(struct plan_scatter *scatter, bool has_grid)
{
    enum { GRID_RUNG = 4, PATH_RUNG = 6 };
    struct plan tried = *scatter->plan;
    double most = -INFINITY;

    set_point(scatter, &tried, has_grid ? GRID_RUNG : SCATTER_PIXELS, PATH_RUNG);
    for (int i = 0; i < scatter->frame_count && scatter->frame_count > 1; i++) {
        double square;

        if (!measure_frame(scatter, &tried, i, &square) && renderer_fault_is_final(scatter->fault)) return false;
        if (!(square > most)) continue;
        most = square;
        scatter->worst = i;
    }
    return true;
}

// The first that serves: without flights to lights, where their grids can be.
static bool find_paths_family(struct plan_scatter *scatter, const struct plan_scene *scene)
{
    for (size_t i = 0; i < plan_family_count; i++) {
        scatter->paths_family = i;
        if (plan_families[i].method == JOB_METHOD_PATHS && plan_family_serves(&plan_families[i], scene)) return true;
    }
    return false;
}

static void describe(struct plan *plan, const struct scatter_finding *finding)
{
    char reason[PLAN_REASON_SIZE];

    memcpy(reason, plan->reason, sizeof reason);
    if (finding->grid_rung == SCATTER_PIXELS)
        snprintf(plan->reason, sizeof plan->reason, "%d paths of each pixel: no grid of scattered light is cheaper",
                 plan->quality.paths);
    else
        snprintf(plan->reason, sizeof plan->reason,
                 "%d cells of scattered light with %d paths each; first order: %.200s", plan->quality.scatter_grid,
                 plan->quality.paths, reason);
}

// The errors of the first order become those of all.
static void predict(struct plan *plan, const struct plan_scatter *scatter, const struct scatter_finding *finding)
{
    double light = scatter->first_share;

    plan->predicted_error = fmax(plan->predicted_error * light, finding->error);
    for (int i = 0; i < plan->scouting.count; i++)
        plan->scouting.error[i] = finding->grid_rung == SCATTER_PIXELS
                                      ? finding->error
                                      : hypot(plan->scouting.error[i] * light, finding->error);
}

bool plan_scatter_complete(struct plan_scatter *scatter, struct plan *plan, enum renderer_fault *fault,
                           struct error *error)
{
    const struct job *job = scatter->params->job;
    struct plan first = *plan;
    struct scatter_finding finding = {.is_stopped = true};
    struct plan_scene scene;
    bool has_grid;

    scatter->plan = &first;
    plan_scene_init(&scene, job);
    has_grid = plan->family < plan_family_count && plan_family_serves(&plan_families[plan->family], &scene);
    if (find_paths_family(scatter, &scene) && find_worst(scatter, has_grid))
        finding = scatter_search_run(
            &(struct scatter_search){.target = SHARE * job->quality.tolerance,
                                     .pixels = (double)job->width_px * job->height_px * job->quality.samples,
                                     .has_grid = has_grid,
                                     .path_max = PATHS_MOST,
                                     .list_pixels = (double)pixel_count(scatter),
                                     .measure = measure,
                                     .user = scatter});
    if (finding.is_stopped) {
        *fault = scatter->fault;
        if (error) *error = scatter->error;
        return false;
    }
    set_point(scatter, plan, finding.grid_rung, finding.path_rung);
    describe(plan, &finding);
    predict(plan, scatter, &finding);
    plan->work = plan_family_work(&scene, &plan->quality);
    return true;
}
