// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_scatter.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/scene/scene.h"
#include "worker/audit/audit_map.h"
#include "worker/audit/truth.h"
#include "worker/model/scene_features.h"
#include "worker/picture/audit_result.h"
#include "worker/picture/image.h"
#include "worker/plan/plan_family.h"
#include "worker/plan/plan_lattice.h"
#include "worker/plan/plan_segment.h"
#include "worker/plan/scatter_march.h"
#include "worker/plan/scatter_pace.h"
#include "worker/plan/scatter_search.h"
#include "worker/plan/scatter_truth.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LIGHT_GRID_RUNG = 6 }; // of paths: 64 cells, whose error is a few thousandths of the light

// Shares of the tolerance, set by hand: the error of the whole plan, that of one for MANY frames, among which a miss
// costs little, and the part of the first order in it.
static const double SHARE = 0.7, SHARE_OF_MANY = 0.9, FIRST_SHARE = 0.4;
static const double FIRST_MOST = 0.5; // the largest tolerance of a job
// Of the tolerance, the error that grids of lights may add to paths of pixels; of the noise, what may look like it.
static const double GRIDS_SHARE = 0.3, CHANCE = 0.5;
// That of each axis of a march which brings scattered light.
static const double MARCH_SHARE = 0.15;
// A frame of few may take as many paths as are traced while its audit begins, which is settled sooner then.
static const double PATHS_CHEAP = 7.5e5;
// Paths that the search may trace: some seconds of a processor. Segments of more frames than MANY may take more.
static const double PATHS_MOST = 8e6, MANY = 6.0, MORE_MOST = 4.0;

struct plan_scatter {
    const struct plan_params *params; // borrowed
    struct scatter_truth truth;
    int worst;         // the frame that the search measures
    struct plan *plan; // that is completed
    size_t paths_family;
    struct scatter_pace paces[SCATTER_PACE_KINDS];
    enum renderer_fault fault;
    struct error error;
};

static size_t pixel_count(const struct plan_scatter *scatter)
{
    return plan_lattice_count(&scatter->truth.lattice);
}

struct plan_scatter *plan_scatter_create(const struct plan_params *params, enum renderer_fault *fault,
                                         struct error *error)
{
    struct plan_scatter *scatter = xcalloc(1, sizeof *scatter);

    scatter->params = params;
    *fault = RENDERER_FAULT_NONE;
    if (scatter_truth_measure(&scatter->truth, params, fault, error)) return scatter;
    plan_scatter_destroy(scatter);
    return NULL;
}

void plan_scatter_destroy(struct plan_scatter *scatter)
{
    if (!scatter) return;
    scatter_truth_finish(&scatter->truth);
    free(scatter);
}

struct job plan_scatter_first_job(const struct plan_scatter *scatter)
{
    struct job first = scatter_truth_first_of(scatter->params->job);
    double tolerance = scatter->params->job->quality.tolerance;

    first.quality.tolerance = fmin(FIRST_SHARE * tolerance / fmax(scatter->truth.first_share, 1e-3), FIRST_MOST);
    return first;
}

// Writes a setting of the scattered light into the plan.
static void set_point(const struct plan_scatter *scatter, struct plan *plan, const struct scatter_setting *setting)
{
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    struct plan_scene scene;
    int count;

    plan_scene_init(&scene, scatter->params->job);
    if (setting->grid_rung == SCATTER_PIXELS) {
        plan->family = scatter->paths_family;
        plan->point = (struct plan_point){.rungs = {0}};
    }
    plan->point.is_from_lights = setting->is_from_lights;
    count = plan_family_axes(&plan_families[plan->family], &scene, axes);
    for (int i = 0; i < count; i++) {
        if (axes[i] == PLAN_AXIS_SCATTER_GRID) plan->point.rungs[i] = setting->grid_rung;
        if (axes[i] == PLAN_AXIS_LIGHT_GRID && setting->grid_rung == SCATTER_PIXELS)
            plan->point.rungs[i] = LIGHT_GRID_RUNG;
        if (axes[i] == PLAN_AXIS_NODE_PATHS || axes[i] == PLAN_AXIS_PIXEL_PATHS)
            plan->point.rungs[i] = setting->path_rung;
    }
    plan->quality = plan_family_quality(&plan_families[plan->family], &scene, &plan->point);
}

// Sums over the pixels of a frame, of squares and of products whose factors have no noise in common.
struct sums {
    double off, noise; // of the first picture and of both halves of the light; of the pictures' difference
    double cells;      // of each picture and another half of the light
    double spread;     // of the squares of each pixel's part of `cells`
};

static struct sums add_pixels(const struct plan_scatter *scatter, const struct scatter_frame *frame,
                              const struct image *first, const struct image *second)
{
    struct sums sums = {0};

    for (size_t i = 0; i < pixel_count(scatter); i++) {
        double before = sums.cells;

        for (size_t c = 0; c < 3; c++) {
            const struct truth_pixel *truth = &frame->truth[i];
            double half = truth->half[c], a = first->rgba[4 * i + c] - truth->rgb[c];
            double b = second ? second->rgba[4 * i + c] - truth->rgb[c] : a;

            sums.off += a * a - half * half;
            sums.noise += 0.5 * (a - b) * (a - b);
            // The mean of (a - half) (b + half) and (a + half) (b - half).
            sums.cells += a * b - half * half;
        }
        sums.spread += pow(sums.cells - before, 2.0);
    }
    return sums;
}

// Of a sum over the pixels, the square of a relative RMSE.
static double relative_of(const struct plan_scatter *scatter, const struct scatter_frame *frame, double sum)
{
    double mean = sum / (3.0 * (double)pixel_count(scatter));

    return frame->light > AUDIT_BLACK * AUDIT_BLACK ? mean / frame->light : mean;
}

typedef bool render_of_lattice(const struct plan_lattice *lattice, const struct plan_params *params,
                               const struct job *job, int32_t frame, struct image *image,
                               struct renderer_result *result, struct error *error);

// Particles from the lights have no counter: the scenes where nothing else fills a grid count them by what one takes.
static void count_walks(const struct plan_scatter *scatter, const struct plan *plan,
                        const struct renderer_result *result, struct scatter_measured *measured)
{
    const struct job_quality *quality = &plan->quality;
    bool has_grid = quality->method != JOB_METHOD_PATHS;

    measured->walks = has_grid ? result->walks : (double)quality->paths * (double)pixel_count(scatter);
    measured->usual_walks = result->steps / SCATTER_USUAL_STEPS;
    if (has_grid && result->walks == 0.0 && !plan->point.is_from_lights) {
        measured->walks = SCATTER_PARTICLE * pow(quality->scatter_grid, 3.0) * quality->paths;
        measured->usual_walks = measured->walks;
    }
}

// `measured`, unless it is NULL, gets the walks of the picture: from the nodes of its grid, or of its pixels.
static bool render(struct plan_scatter *scatter, const struct plan *plan, const struct scatter_frame *frame,
                   render_of_lattice *draw, struct image *image, struct scatter_measured *measured)
{
    struct job planned = scatter->truth.job;
    struct renderer_result result = {0};
    bool ok;

    planned.quality = plan->quality;
    planned.quality.samples = 1;
    ok = draw(&scatter->truth.lattice, scatter->params, &planned, frame->number, image, &result, &scatter->error);
    scatter_progress_count_picture(&scatter->truth.progress);
    scatter->fault = result.fault;
    if (ok && measured) count_walks(scatter, plan, &result, measured);
    return ok;
}

// The product of the differences to both halves of the light, so that its noise counts nothing.
static bool measure_frame(struct plan_scatter *scatter, const struct plan *plan, int index, double *square)
{
    const struct scatter_frame *frame = &scatter->truth.frames[index];
    struct image image = {0};
    bool ok = render(scatter, plan, frame, plan_lattice_render, &image, NULL);

    *square = INFINITY;
    if (ok) *square = relative_of(scatter, frame, add_pixels(scatter, frame, &image, NULL).off);
    image_finish(&image);
    return ok;
}

// The second picture links and reads nothing: its time is that of its paths.
static bool render_again(struct plan_scatter *scatter, const struct scatter_setting *setting, const struct plan *plan,
                         const struct scatter_frame *frame, struct image *image, struct scatter_measured *measured)
{
    struct scatter_pace began = scatter_pace_begin();

    if (!render(scatter, plan, frame, plan_lattice_render_again, image, measured)) return false;
    scatter_pace_note(scatter->paces, setting, (double)pixel_count(scatter), &began);
    return true;
}

// Two pictures tell the noise by their difference, and by their product with the two halves of the light what has none.
static bool measure_twice(struct plan_scatter *scatter, const struct scatter_setting *setting,
                          struct scatter_measured *measured)
{
    const struct scatter_frame *frame = &scatter->truth.frames[scatter->worst];
    struct plan tried = *scatter->plan;
    struct image first = {0}, second = {0};
    bool ok;

    set_point(scatter, &tried, setting);
    *measured = (struct scatter_measured){.cells = INFINITY, .noise = INFINITY};
    ok = render(scatter, &tried, frame, plan_lattice_render, &first, NULL) &&
         render_again(scatter, setting, &tried, frame, &second, measured);
    if (ok) {
        struct sums sums = add_pixels(scatter, frame, &first, &second);

        measured->noise = relative_of(scatter, frame, sums.noise);
        measured->cells = relative_of(scatter, frame, sums.cells);
        measured->chance = relative_of(scatter, frame, sqrt(sums.spread));
        log_debug("plan: scattered light by %d cells, %d paths%s: error of cells %.2e (chance %.2e), noise %.2e",
                  tried.quality.scatter_grid, tried.quality.paths, setting->is_from_lights ? " from the lights" : "",
                  sqrt(fmax(measured->cells, 0.0)), sqrt(measured->chance), sqrt(measured->noise));
    }
    image_finish(&second);
    image_finish(&first);
    return ok || !renderer_fault_is_final(scatter->fault);
}

static bool measure(void *user, const struct scatter_setting *setting, struct scatter_measured *measured)
{
    struct plan_scatter *scatter = user;
    double tolerance = scatter->params->job->quality.tolerance;

    if (!measure_twice(scatter, setting, measured)) return false;
    // Grids of the lights that are too coarse for paths of pixels: these go without from then on.
    if (setting->grid_rung != SCATTER_PIXELS || isinf(measured->cells) ||
        measured->cells <= GRIDS_SHARE * GRIDS_SHARE * tolerance * tolerance + CHANCE * measured->noise)
        return true;
    if (scatter->paths_family + 1 >= plan_family_count ||
        plan_families[scatter->paths_family + 1].method != JOB_METHOD_PATHS)
        return true;
    scatter->paths_family++;
    return measure_twice(scatter, setting, measured);
}

// Whether a grid may be filled from the lights where the scene alone would not have it so. Media's own light is not
// sent; spheres and images of domes always are.
static bool may_choose(const struct job *job)
{
    for (size_t i = 0; i < job->scene.light_count; i++) {
        const struct scene_light *light = &job->scene.lights[i];

        if (light->kind == SCENE_LIGHT_SPHERE ||
            (light->kind == SCENE_LIGHT_DOME && light->dome.kind == SCENE_DOME_FILE))
            return false;
    }
    return job->scene.light_count > 0 && !scene_features_of(job, NULL).has_emission;
}

// The frame with the largest error of the cheapest setting is the one that the search measures.
static bool find_worst(struct plan_scatter *scatter, bool has_grid)
{
    static const struct scatter_setting GRID = {.grid_rung = 4, .path_rung = 12},
                                        PIXEL = {.grid_rung = SCATTER_PIXELS, .path_rung = 12};
    struct plan tried = *scatter->plan;
    double most = -INFINITY;

    set_point(scatter, &tried, has_grid ? &GRID : &PIXEL);
    for (int i = 0; i < scatter->truth.frame_count && scatter->truth.frame_count > 1; i++) {
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

void plan_scatter_describe_paths(struct plan *plan)
{
    snprintf(plan->reason, sizeof plan->reason,
             "%d paths of each %spixel: no grid of scattered light is known to be cheaper", plan->quality.paths,
             plan->pixels.stride > 0 ? "traced " : "");
}

static void describe(struct plan *plan, const struct scatter_finding *finding)
{
    char reason[PLAN_REASON_SIZE];

    memcpy(reason, plan->reason, sizeof reason);
    if (finding->setting.grid_rung == SCATTER_PIXELS)
        plan_scatter_describe_paths(plan);
    else
        snprintf(plan->reason, sizeof plan->reason, "%d cells of scattered light with %d %s each; first order: %.200s",
                 plan->quality.scatter_grid, plan->quality.paths,
                 finding->setting.is_from_lights ? "particles from the lights" : "paths", reason);
}

// The errors of the first order become those of all. The march was refined for the middle frame, whose error the
// search's pictures have, too; where the first order alone errs by more, so do all orders.
static void predict(struct plan *plan, const struct plan_scatter *scatter, const struct scatter_finding *finding)
{
    struct plan_scouting *scouting = &plan->scouting;
    bool has_grid = finding->setting.grid_rung != SCATTER_PIXELS;
    double middle = scouting->count > 0 ? scouting->error[scouting->count / 2] : 0.0;
    double kept = fmin(middle * scatter->truth.first_share, MARCH_SHARE * scatter->params->job->quality.tolerance);

    plan->predicted_error = finding->error;
    plan->cells_square = finding->cells;
    plan->paths_square = fmax(finding->error * finding->error - finding->cells, 0.0);
    for (int i = 0; i < scouting->count; i++) {
        double growth = scouting->error[i] / fmax(middle, 1e-30);
        double more = middle > 0.0 ? kept * sqrt(fmax(growth * growth - 1.0, 0.0))
                                   : scouting->error[i] * scatter->truth.first_share;

        scouting->error[i] = has_grid ? hypot(finding->error, more) : finding->error;
    }
}

// Seconds of a frame by the pace of its paths. No plan depends on them.
static void foretell(struct plan *plan, const struct plan_scatter *scatter, const struct scatter_setting *setting)
{
    const struct job *job = scatter->params->job;
    double samples = job->quality.samples > 1 ? job->quality.samples : 1.0;
    struct scatter_pace frame =
        scatter_pace_foretell(scatter->paces, setting, samples * job->width_px * job->height_px);

    plan->predicted_s = frame.wall_s;
    if (renderer_is_software(scatter->params->renderer)) plan->predicted_processor_s = frame.processor_s;
}

static bool refine_march(struct plan_scatter *scatter, struct plan *plan)
{
    const struct scatter_frame *frame = &scatter->truth.frames[scatter->truth.frame_count / 2];

    return scatter_march_refine(
        &(struct scatter_march_params){.lattice = &scatter->truth.lattice,
                                       .params = scatter->params,
                                       .job = &scatter->truth.job,
                                       .frame = frame->number,
                                       .light = frame->light,
                                       .most = MARCH_SHARE * scatter->params->job->quality.tolerance},
        plan, &scatter->fault, &scatter->error);
}

bool plan_scatter_complete(struct plan_scatter *scatter, struct plan *plan, enum renderer_fault *fault,
                           struct error *error)
{
    const struct job *job = scatter->params->job;
    double frames = plan_segment_pictures(job, &scatter->params->segment);
    struct plan first;
    struct scatter_finding finding = {.is_stopped = true};
    struct plan_scene scene;
    bool has_grid;

    scatter->plan = &first;
    plan_scene_init(&scene, job);
    has_grid = plan->family < plan_family_count && plan_family_serves(&plan_families[plan->family], &scene);
    if (has_grid && !refine_march(scatter, plan)) {
        log_info("plan: no grid of scattered light: %s", scatter->error.message);
        has_grid = false;
    }
    first = *plan;
    if (find_paths_family(scatter, &scene) && find_worst(scatter, has_grid))
        finding = scatter_search_run(
            &(struct scatter_search){.target = (frames < MANY ? SHARE : SHARE_OF_MANY) * job->quality.tolerance,
                                     .pixels = (double)job->width_px * job->height_px * job->quality.samples,
                                     .frames = frames,
                                     .has_grid = has_grid,
                                     .may_choose = may_choose(job),
                                     .path_max = PATHS_MOST * fmin(fmax(frames / MANY, 1.0), MORE_MOST),
                                     .list_pixels = (double)pixel_count(scatter),
                                     .measure = measure,
                                     .user = scatter});
    if (finding.is_stopped) {
        *fault = scatter->fault;
        if (error) *error = scatter->error;
        return false;
    }
    if (frames < MANY) scatter_finding_refine(&finding, PATHS_CHEAP);
    set_point(scatter, plan, &finding.setting);
    log_debug("plan: scattered light: %s, error %.2e, %.2e usual paths", finding.is_found ? "found" : "the nearest",
              finding.error, finding.paths);
    describe(plan, &finding);
    predict(plan, scatter, &finding);
    foretell(plan, scatter, &finding.setting);
    plan->work = plan_family_work(&scene, &plan->quality);
    return true;
}
