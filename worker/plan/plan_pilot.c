// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_pilot.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/audit/truth.h"
#include "worker/plan/finite_check.h"
#include "worker/plan/plan_budget.h"
#include "worker/plan/plan_evidence.h"
#include "worker/plan/plan_lattice.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/plan_pilot_frame.h"
#include "worker/plan/plan_progress.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    PIXELS_MIN = 16 * 12, // of a frame that are drawn
    PIXELS_MAX = 64 * 36,
    LEVEL_USUAL = 4,  // halvings that scenes need: the number of pixels follows from their work
    LEVEL_MIN = 2,    // halvings at least: two coarse renders may agree by accident
    LEVEL_LIMIT = 10, // halvings at most
    FILLED_LIMIT = 64
};

// The change by one more halving, relative to the tolerance, at which a render is fine enough: where reference/
// corrects the error estimate, and where it cannot. Set by hand; tests/worker/plan/tolerance_random_test and
// tolerance_promise_test check them.
static const double AGREEMENT = 0.5, AGREEMENT_ALONE = 0.15;
// The share of the plan's budget that a halving may take: where reference/ corrects the error estimate, and where it
// cannot.
static const double LEVEL_SHARE = 0.3, LEVEL_SHARE_ALONE = 1.0;

struct plan_pilot {
    const struct plan_params *params; // borrowed
    struct job job;                   // a shallow copy, with one sample
    struct plan_lattice lattice;
    struct plan_scene scene;
    float *depths; // owned
    struct plan_pilot_frame frames[PLAN_PILOT_LIMIT];
    int frame_count;
    bool has_truth;
    struct job_quality fine_quality; // of the finest renders
    int pixel_limit;                 // of the lattice
    int first_level;                 // of the steps' halvings
    int start_level, render_count;
    double evaluations;
    // The light grids that measurements have filled: another one with the same grid does not fill it again.
    struct {
        int frame, cells;
    } filled[FILLED_LIMIT];
    int filled_count;
    enum renderer_fault fault;
    struct error error;
};

static size_t pixel_count(const struct plan_pilot *pilot)
{
    return plan_lattice_count(&pilot->lattice);
}

static void init_job(struct plan_pilot *pilot, const struct job *job)
{
    pilot->job = *job;
    pilot->job.quality.samples = 1;
}

static void init_scene(struct plan_pilot *pilot, const struct job *job)
{
    plan_scene_init(&pilot->scene, job);
    pilot->has_truth = truth_has_twin(job) && !pilot->scene.has_roughness;
}

// PLAN_CANNOT for faults of this setting, which another may not have.
static enum plan_measured render(struct plan_pilot *pilot, const struct job_quality *quality, int32_t frame,
                                 struct image *image)
{
    struct renderer_result result;
    struct job job = pilot->job;

    job.quality = *quality;
    pilot->error = (struct error){0};
    pilot->render_count++;
    if (plan_lattice_render(&pilot->lattice, pilot->params, &job, frame, image, &result, &pilot->error))
        return PLAN_MEASURED;
    pilot->fault = result.fault;
    return result.fault == RENDERER_FAULT_JOB || result.fault == RENDERER_FAULT_ENDLESS ? PLAN_CANNOT : PLAN_STOPPED;
}

// Where there is a transfer function, `preintegrated`: other methods step over its thin shells, and two halvings agree
// without them. Else the first family that serves the scene and has an error of second order in all its steps and
// cells. `cached` stands before `midpoint`: n³ evaluations per frame for a light grid are few beside those of marches
// for each pixel.
static const struct plan_family *find_finest(const struct plan_pilot *pilot)
{
    for (size_t i = 0; i < plan_family_count; i++)
        if (plan_families[i].method == JOB_METHOD_PREINTEGRATED && plan_family_serves(&plan_families[i], &pilot->scene))
            return &plan_families[i];
    for (size_t i = 0; i < plan_family_count; i++) {
        const struct plan_family *family = &plan_families[i];
        bool is_of_second_order =
            family->method == JOB_METHOD_EQUIANGULAR || family->method == JOB_METHOD_MIDPOINT ||
            (family->method == JOB_METHOD_CACHED &&
             plan_family_quality(family, &pilot->scene, &(struct plan_point){.rungs = {0}}).density_grid == 0);

        if (is_of_second_order && plan_family_serves(family, &pilot->scene)) return family;
    }
    return NULL;
}

// All axes halved `level` times, steps further than that by the pilot's first level, and the thresholds so low that
// next to nothing is cut.
static struct job_quality quality_at(const struct plan_pilot *pilot, const struct plan_family *family, int level)
{
    enum { POINTS_FIRST = 5, GRID_FIRST = 2, GRID_ENOUGH = 8, PATHS = 4 };
    static const double STRICT = 5e-3;
    bool is_strict = pilot->params->job->quality.tolerance < STRICT;
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    struct plan_point point = {.rungs = {0}};
    int count = plan_family_axes(family, &pilot->scene, axes);

    for (int i = 0; i < count; i++) {
        int last = plan_axis_last_rung(axes[i], &pilot->scene), rung = 2 * level;
        bool is_step = axes[i] == PLAN_AXIS_STEP || axes[i] == PLAN_AXIS_LIGHT_STEP;

        if (is_step) rung += 2 * pilot->first_level;
        if (axes[i] == PLAN_AXIS_POINTS) rung += POINTS_FIRST;
        // 128 cells leave a smaller error than is asked about, unless the tolerance is strict.
        if (axes[i] == PLAN_AXIS_LIGHT_GRID) {
            rung += GRID_FIRST;
            if (!is_strict && rung > GRID_ENOUGH) rung = GRID_ENOUGH;
        }
        if (axes[i] == PLAN_AXIS_MIN_TRANSMITTANCE) rung = last;
        if (axes[i] == PLAN_AXIS_PATHS) rung = PATHS;
        point.rungs[i] = rung < last ? rung : last;
    }
    return plan_family_quality(family, &pilot->scene, &point);
}

static void drop_frame(struct plan_pilot *pilot, int i)
{
    plan_pilot_frame_finish(&pilot->frames[i]);
    memmove(&pilot->frames[i], &pilot->frames[i + 1], (size_t)(pilot->frame_count - i - 1) * sizeof *pilot->frames);
    pilot->frame_count--;
    pilot->frames[pilot->frame_count] = (struct plan_pilot_frame){0};
}

// True when a colour of the frame's last render is not finite; then the fault and the error say why.
static bool is_spoilt(struct plan_pilot *pilot, const struct job_quality *quality, const struct plan_pilot_frame *frame)
{
    struct job job = pilot->job;
    size_t index;

    if (!finite_check_find(&frame->seen, &index)) return false;
    job.quality = *quality;
    finite_check_tell(pilot->params->renderer, &job, frame->number, pilot->lattice.pixels[index], &pilot->error);
    pilot->fault = RENDERER_FAULT_JOB;
    return true;
}

// Renders all frames anew and keeps the renders as their finest. Frames whose files cannot be read are dropped.
static enum plan_measured render_finer(struct plan_pilot *pilot, const struct job_quality *quality)
{
    for (int i = 0; i < pilot->frame_count; i++) {
        struct plan_pilot_frame *frame = &pilot->frames[i];
        enum plan_measured measured = render(pilot, quality, frame->number, &frame->seen);

        if (measured == PLAN_STOPPED && pilot->fault == RENDERER_FAULT_FRAME && pilot->frame_count > 1) {
            drop_frame(pilot, i--);
            continue;
        }
        if (measured != PLAN_MEASURED) return measured;
        if (is_spoilt(pilot, quality, frame)) return PLAN_STOPPED;
        plan_pilot_frame_keep(frame);
    }
    return PLAN_MEASURED;
}

static double find_change(const struct plan_pilot *pilot)
{
    double largest = 0.0;

    for (int i = 0; i < pilot->frame_count; i++)
        largest = fmax(largest, plan_pilot_frame_change(&pilot->frames[i]));
    return largest;
}

// The mean transmittance of a pixel's rays; negative where the picture has neither transmittance nor alpha.
static double transmittance_at(const struct plan_pilot *pilot, const struct image *image, size_t i)
{
    if (image->transmittance)
        return (image->transmittance[4 * i] + image->transmittance[4 * i + 1] + image->transmittance[4 * i + 2]) / 3.0;
    return scene_has_behind(&pilot->job.scene) ? -1.0 : 1.0 - image->rgba[4 * i + 3];
}

static void note_depths(struct plan_pilot *pilot)
{
    static const double CLEAR = 1e-4, DARKEST = 1e-9;
    size_t count = pixel_count(pilot), hit_count = 0;

    free(pilot->depths);
    pilot->depths = xcalloc((size_t)pilot->frame_count * count, sizeof *pilot->depths);
    for (int f = 0; f < pilot->frame_count; f++)
        for (size_t i = 0; i < count; i++) {
            double transmittance = transmittance_at(pilot, &pilot->frames[f].fine, i);

            if (transmittance < 0.0) transmittance = exp(-1.0);
            if (!pilot->scene.has_extinction) transmittance = 1.0;
            if (pilot->scene.has_extinction && transmittance > 1.0 - CLEAR) continue;
            pilot->depths[hit_count++] = (float)-log(fmax(transmittance, DARKEST));
        }
    pilot->scene.depths = pilot->depths;
    pilot->scene.depth_count = hit_count;
    pilot->scene.hit_share = (double)hit_count / ((double)pilot->frame_count * (double)count);
}

// Evaluations of density in the drawn pixels of one frame, with that quality.
static double count_evaluations(const struct plan_pilot *pilot, const struct job_quality *quality)
{
    struct plan_scene scene = pilot->scene;

    scene.pixels = (double)pixel_count(pilot);
    return plan_family_work(&scene, quality) * scene.pixels;
}

// As many pixels of each frame as a halving of rays that nothing ends may draw for that work.
static double affordable_pixels(const struct plan_pilot *pilot, const struct plan_family *family, int level,
                                double most)
{
    static const float CLEAR = 0.0f;
    struct plan_scene scene = pilot->scene;
    struct job_quality quality = quality_at(pilot, family, level);

    scene.depths = &CLEAR;
    scene.depth_count = 1;
    scene.hit_share = 1.0;
    return most / (pilot->frame_count * plan_family_work(&scene, &quality));
}

static void choose_pixels(struct plan_pilot *pilot, const struct plan_family *family, double most)
{
    double affordable;

    pilot->first_level = pilot->scene.small_level;
    while (pilot->first_level > 0 && affordable_pixels(pilot, family, LEVEL_MIN, most) < PIXELS_MIN)
        pilot->first_level--;
    affordable = affordable_pixels(pilot, family, LEVEL_USUAL, most);
    pilot->pixel_limit = (int)fmin(fmax(affordable, PIXELS_MIN), PIXELS_MAX);
    plan_lattice_init(&pilot->lattice, pilot->params->job, pilot->pixel_limit);
}

static bool is_filled(struct plan_pilot *pilot, int frame, int cells)
{
    for (int i = 0; i < pilot->filled_count; i++)
        if (pilot->filled[i].frame == frame && pilot->filled[i].cells == cells) return true;
    if (pilot->filled_count == FILLED_LIMIT) return false;
    pilot->filled[pilot->filled_count].frame = frame;
    pilot->filled[pilot->filled_count++].cells = cells;
    return false;
}

static void note_evaluations(struct plan_pilot *pilot, const struct job_quality *quality, int frame)
{
    struct job_quality counted = *quality;

    if (is_filled(pilot, frame, quality->light_grid)) counted.light_grid = 0;
    pilot->evaluations += count_evaluations(pilot, &counted);
}

// Halves the steps until the picture hardly changes. The remaining error is a third of the last change, by second
// order.
static bool make_fine(struct plan_pilot *pilot)
{
    const struct plan_family *family = find_finest(pilot);
    double tolerance = pilot->params->job->quality.tolerance;
    double enough = (pilot->has_truth ? AGREEMENT : AGREEMENT_ALONE) * tolerance;
    double share = pilot->has_truth ? LEVEL_SHARE : LEVEL_SHARE_ALONE, most, spent = 0.0;
    int level = 0;

    if (!family) {
        pilot->fault = RENDERER_FAULT_JOB;
        error_set(&pilot->error, "quality.tolerance: no method renders this scene");
        return false;
    }
    plan_scene_measure_lengths(&pilot->scene, pilot->params->segment.pilot, pilot->params->segment.pilot_count);
    most = share * plan_budget_find(pilot->params, &pilot->scene);
    choose_pixels(pilot, family, most);
    pilot->start_level = -1;
    for (; level < LEVEL_LIMIT; level++) {
        struct job_quality quality = quality_at(pilot, family, level);
        enum plan_measured measured;
        double change;

        if (level > LEVEL_MIN && pilot->frame_count * count_evaluations(pilot, &quality) > most) break;
        measured = render_finer(pilot, &quality);
        if (measured == PLAN_STOPPED || (measured == PLAN_CANNOT && level == 0)) return false;
        // The frames before the one that cannot be rendered so are those of the level before again.
        if (measured == PLAN_CANNOT && render_finer(pilot, &pilot->fine_quality) != PLAN_MEASURED) return false;
        if (measured == PLAN_CANNOT) break;
        pilot->fine_quality = quality;
        note_depths(pilot);
        most = share * plan_budget_find(pilot->params, &pilot->scene);
        spent += pilot->frame_count * count_evaluations(pilot, &quality);
        plan_progress_note(pilot->params, PLAN_STAGE_HALVING, spent / most);
        if (level == 0) continue;
        change = find_change(pilot);
        log_debug("plan: %s, halved %d times: changed by %.2e, %.2e evaluations", family->name, level, change,
                  pilot->frame_count * count_evaluations(pilot, &quality));
        if (pilot->start_level < 0 && change <= tolerance) pilot->start_level = level - 1;
        if (level >= LEVEL_MIN && change <= enough) break;
    }
    if (pilot->start_level < 0) pilot->start_level = level > 0 ? level - 1 : 0;
    pilot->start_level += pilot->first_level;
    pilot->fault = RENDERER_FAULT_NONE;
    return true;
}

static bool prepare(struct plan_pilot *pilot)
{
    const struct plan_segment *segment = &pilot->params->segment;

    pilot->frame_count = segment->pilot_count;
    for (int i = 0; i < segment->pilot_count; i++)
        pilot->frames[i] = (struct plan_pilot_frame){.number = segment->pilot[i]};
    if (!make_fine(pilot)) return false;
    for (int i = 0; i < pilot->frame_count && pilot->has_truth; i++) {
        plan_pilot_frame_draw(&pilot->frames[i], &pilot->job,
                              pilot->frame_count > 1 ? PLAN_TRUE_PIXELS_EACH : PLAN_TRUE_PIXELS);
        if (!plan_pilot_frame_measure(&pilot->frames[i], pilot->params, &pilot->lattice, &pilot->job, &pilot->fault,
                                      &pilot->error))
            return false;
        plan_progress_note(pilot->params, PLAN_STAGE_TRUTH, (i + 1.0) / pilot->frame_count);
    }
    return true;
}

struct plan_pilot *plan_pilot_create(const struct plan_params *params, enum renderer_fault *fault, struct error *error)
{
    struct plan_pilot *pilot = xcalloc(1, sizeof *pilot);

    pilot->params = params;
    init_job(pilot, params->job);
    init_scene(pilot, params->job);
    *fault = RENDERER_FAULT_NONE;
    if (prepare(pilot)) return pilot;
    *fault = plan_pilot_fault(pilot, error);
    plan_pilot_destroy(pilot);
    return NULL;
}

void plan_pilot_destroy(struct plan_pilot *pilot)
{
    if (!pilot) return;
    for (int i = 0; i < PLAN_PILOT_LIMIT; i++)
        plan_pilot_frame_finish(&pilot->frames[i]);
    plan_lattice_finish(&pilot->lattice);
    free(pilot->depths);
    free(pilot);
}

const struct plan_scene *plan_pilot_scene(const struct plan_pilot *pilot)
{
    return &pilot->scene;
}

int plan_pilot_start_level(const struct plan_pilot *pilot)
{
    return pilot->start_level;
}

double plan_pilot_fine_work(const struct plan_pilot *pilot)
{
    return plan_family_work(&pilot->scene, &pilot->fine_quality);
}

int plan_pilot_count_renders(const struct plan_pilot *pilot)
{
    return pilot->render_count;
}

const struct plan_family *plan_pilot_finest(const struct plan_pilot *pilot)
{
    return find_finest(pilot);
}

double plan_pilot_count_evaluations(const struct plan_pilot *pilot)
{
    return pilot->evaluations;
}

enum plan_measured plan_pilot_measure(struct plan_pilot *pilot, const struct job_quality *quality, int only,
                                      struct plan_errors *errors)
{
    double sum = 0.0;

    *errors = (struct plan_errors){0};
    for (int i = 0; i < pilot->frame_count; i++) {
        struct plan_pilot_frame *frame = &pilot->frames[i];
        enum plan_measured measured;
        double error;

        if (only != PLAN_ALL_FRAMES && i != only) continue;
        measured = render(pilot, quality, frame->number, &frame->seen);

        if (measured != PLAN_MEASURED) return measured;
        note_evaluations(pilot, quality, i);
        error = plan_pilot_frame_error(frame);
        if (isnan(error)) error = INFINITY;
        if (error > errors->largest) errors->worst = i;
        errors->largest = fmax(errors->largest, error);
        errors->each[errors->count++] = error;
        sum += error * error;
    }
    errors->mean = sqrt(sum / errors->count);
    return PLAN_MEASURED;
}

enum renderer_fault plan_pilot_fault(const struct plan_pilot *pilot, struct error *error)
{
    if (error) *error = pilot->error;
    return pilot->fault;
}

void plan_pilot_give(struct plan_pilot *pilot, struct plan_evidence *evidence)
{
    for (int i = 0; i < pilot->frame_count; i++) {
        struct plan_pilot_frame *frame = &pilot->frames[i];

        plan_pilot_frame_fill(frame, pilot->job.output.pixel, &evidence->pool);
        evidence->views[i] = (struct plan_view){.frame = frame->number, .finer = frame->fine, .coarser = frame->seen};
        frame->fine = frame->seen = (struct image){0};
    }
    evidence->view_count = pilot->frame_count;
    evidence->finest = pilot->fine_quality;
    evidence->pixel_limit = pilot->pixel_limit;
}
