// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_pilot.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/audit/audit.h"
#include "worker/audit/audit_map.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"
#include "worker/plan/plan_evidence.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    PIXELS = 64 * 36, // of a small frame, at most
    TRUE_PIXELS = 32, // of each that reference/ measures
    LEVEL_MIN = 2,    // two coarse renders may agree by accident
    LEVEL_LIMIT = 10
};

static const double BLACK = 1e-6, DARK_SHARE = 0.1;
// How near two renders of steps that differ by half are, beside the tolerance: where reference/ has the last word, and else.
static const double AGREEMENT = 0.5, AGREEMENT_ALONE = 0.15;
static const double ACCURACY_SHARE = 0.05, ACCURACY_MIN = 1e-4, ACCURACY_MAX = 1e-2; // of reference/
// Looks for a finer render, at most, where reference/ says what the finest is off.
static const double LOOKS_OF_A_LEVEL = 2e8;

struct pilot_frame {
    int32_t number;
    struct image fine, before, seen; // the finest, the one before it, and the last that was measured
    double mean_square;              // of the light
    size_t true_count;
    struct truth_place places[TRUE_PIXELS];
    struct truth_pixel truth[TRUE_PIXELS];
    double density[TRUE_PIXELS]; // of the pixel's draw
};

struct plan_pilot {
    struct plan_pilot_params params;
    struct job job; // a small copy, which owns nothing
    struct plan_scene scene;
    float *depths; // owned
    struct pilot_frame frames[PLAN_PILOT_LIMIT];
    int frame_count;
    bool has_truth;
    struct job_quality fine_quality; // of the finest render
    int start_level, render_count;
    double looks;
    enum renderer_fault fault;
    struct error error;
};

static size_t pixel_count(const struct plan_pilot *pilot)
{
    return (size_t)pilot->job.width_px * (size_t)pilot->job.height_px;
}

static void init_job(struct plan_pilot *pilot, const struct job *job)
{
    double scale = fmin(1.0, sqrt(PIXELS / ((double)job->width_px * job->height_px)));

    pilot->job = *job;
    pilot->job.width_px = (int)fmax(1.0, round(scale * job->width_px));
    pilot->job.height_px = (int)fmax(1.0, round(scale * job->height_px));
    pilot->job.quality.samples = 1;
}

static void init_scene(struct plan_pilot *pilot, const struct job *job)
{
    plan_scene_init(&pilot->scene, job);
    pilot->has_truth = truth_has_twin(job) && !pilot->scene.has_roughness;
}

static bool on_tile(void *user, double done)
{
    const struct plan_pilot *pilot = user;

    (void)done;
    return !pilot->params.on_progress || pilot->params.on_progress(pilot->params.user, 0.0);
}

static bool on_pixel(void *user)
{
    return on_tile(user, 0.0);
}

// Faults that another setting does not have end nothing but this one.
static enum plan_measured render(struct plan_pilot *pilot, const struct job_quality *quality, int32_t frame,
                                 struct image *image)
{
    struct renderer_result result;
    struct job job = pilot->job;

    job.quality = *quality;
    job.quality.samples = 1;
    pilot->error = (struct error){0};
    pilot->render_count++;
    if (renderer_render(pilot->params.renderer, &job, frame, image, on_tile, pilot, &result, &pilot->error))
        return PLAN_MEASURED;
    pilot->fault = result.fault;
    return result.fault == RENDERER_FAULT_JOB || result.fault == RENDERER_FAULT_ENDLESS ? PLAN_CANNOT : PLAN_STOPPED;
}

static double squared_difference(const struct plan_pilot *pilot, const struct image *a, const struct image *b)
{
    double sum = 0.0;

    for (size_t i = 0; i < pixel_count(pilot); i++)
        for (size_t c = 0; c < 3; c++) {
            double apart = (double)a->rgba[4 * i + c] - (b ? b->rgba[4 * i + c] : 0.0);

            sum += apart * apart / 3.0;
        }
    return sum / (double)pixel_count(pilot);
}

static double relative(double square, double mean_square)
{
    return sqrt(mean_square > BLACK * BLACK ? square / mean_square : square);
}

// Of those whose error falls with the square of all steps and cells. Light is looked up where there is some: of n³ looks for
// a frame there is none that is too fine.
static const struct plan_family *find_finest(const struct plan_pilot *pilot)
{
    for (size_t i = 0; i < plan_family_count; i++) {
        const struct plan_family *family = &plan_families[i];
        bool is_of_second_order =
            family->method == JOB_METHOD_EQUIANGULAR || family->method == JOB_METHOD_MIDPOINT ||
            (family->method == JOB_METHOD_CACHED &&
             plan_family_quality(family, &pilot->scene, &(struct plan_point){{0}}).density_grid == 0);

        if (is_of_second_order && plan_family_serves(family, &pilot->scene)) return family;
    }
    return NULL;
}

// All steps alike, and next to nothing left out.
static struct job_quality quality_at(const struct plan_pilot *pilot, const struct plan_family *family, int level)
{
    enum { POINTS_FIRST = 5, GRID_FIRST = 2, GRID_ENOUGH = 8, PATHS = 4 };
    static const double STRICT = 5e-3;
    bool is_strict = pilot->params.job->quality.tolerance < STRICT;
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    struct plan_point point = {{0}};
    int count = plan_family_axes(family, &pilot->scene, axes);

    for (int i = 0; i < count; i++) {
        int last = plan_axis_last_rung(axes[i], &pilot->scene), rung = 2 * level;

        if (axes[i] == PLAN_AXIS_POINTS) rung += POINTS_FIRST;
        // A grid of 128 cells leaves less than what is asked about, unless little is allowed.
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
    image_finish(&pilot->frames[i].fine);
    image_finish(&pilot->frames[i].before);
    image_finish(&pilot->frames[i].seen);
    memmove(&pilot->frames[i], &pilot->frames[i + 1], (size_t)(pilot->frame_count - i - 1) * sizeof *pilot->frames);
    pilot->frame_count--;
    pilot->frames[pilot->frame_count] = (struct pilot_frame){0};
}

// Renders all frames into `fine`, what that held going to `before`. Frames without their files are dropped.
static enum plan_measured render_finer(struct plan_pilot *pilot, const struct job_quality *quality)
{
    for (int i = 0; i < pilot->frame_count; i++) {
        struct pilot_frame *frame = &pilot->frames[i];
        enum plan_measured measured = render(pilot, quality, frame->number, &frame->seen);
        struct image spare = frame->before;

        if (measured == PLAN_STOPPED && pilot->fault == RENDERER_FAULT_FRAME && pilot->frame_count > 1) {
            drop_frame(pilot, i--);
            continue;
        }
        if (measured != PLAN_MEASURED) return measured;
        frame->before = frame->fine;
        frame->fine = frame->seen;
        frame->seen = spare;
    }
    return PLAN_MEASURED;
}

static double find_change(const struct plan_pilot *pilot)
{
    double largest = 0.0;

    for (int i = 0; i < pilot->frame_count; i++) {
        const struct pilot_frame *frame = &pilot->frames[i];
        double mean_square = squared_difference(pilot, &frame->fine, NULL);

        largest = fmax(largest, relative(squared_difference(pilot, &frame->fine, &frame->before), mean_square));
    }
    return largest;
}

// The mean transmittance of a pixel's ray; negative where the picture does not say.
static double transmittance_at(const struct plan_pilot *pilot, const struct image *image, size_t i)
{
    if (image->transmittance)
        return (image->transmittance[4 * i] + image->transmittance[4 * i + 1] + image->transmittance[4 * i + 2]) / 3.0;
    return pilot->job.scene.has_background ? -1.0 : 1.0 - image->rgba[4 * i + 3];
}

static void note_depths(struct plan_pilot *pilot)
{
    static const double CLEAR = 1e-4, DARKEST = 1e-9;
    size_t count = pixel_count(pilot), met = 0;

    free(pilot->depths);
    pilot->depths = xcalloc((size_t)pilot->frame_count * count, sizeof *pilot->depths);
    for (int f = 0; f < pilot->frame_count; f++)
        for (size_t i = 0; i < count; i++) {
            double transmittance = transmittance_at(pilot, &pilot->frames[f].fine, i);

            if (transmittance < 0.0) transmittance = exp(-1.0);
            if (!pilot->scene.has_extinction) transmittance = 1.0;
            if (pilot->scene.has_extinction && transmittance > 1.0 - CLEAR) continue;
            pilot->depths[met++] = (float)-log(fmax(transmittance, DARKEST));
        }
    pilot->scene.depths = pilot->depths;
    pilot->scene.depth_count = met;
    pilot->scene.met = (double)met / ((double)pilot->frame_count * (double)count);
}

// Of all frames with one quality, made anew.
static double looks_of(const struct plan_pilot *pilot, const struct job_quality *quality)
{
    struct plan_scene scene = pilot->scene;

    scene.pixels = (double)pixel_count(pilot);
    return plan_family_work(&scene, quality) * scene.pixels;
}

// Halves the steps until nothing changes. Of second order, what is off is a third of the last change.
static bool make_fine(struct plan_pilot *pilot)
{
    const struct plan_family *family = find_finest(pilot);
    double tolerance = pilot->params.job->quality.tolerance;
    double enough = (pilot->has_truth ? AGREEMENT : AGREEMENT_ALONE) * tolerance;
    int level = 0;

    if (!family) {
        pilot->fault = RENDERER_FAULT_JOB;
        error_set(&pilot->error, "quality.tolerance: no method renders this scene");
        return false;
    }
    pilot->start_level = -1;
    for (; level < LEVEL_LIMIT; level++) {
        struct job_quality quality = quality_at(pilot, family, level);
        enum plan_measured measured;
        double change;

        if (level > LEVEL_MIN && pilot->has_truth && pilot->frame_count * looks_of(pilot, &quality) > LOOKS_OF_A_LEVEL)
            break;
        measured = render_finer(pilot, &quality);
        if (measured == PLAN_STOPPED || (measured == PLAN_CANNOT && level == 0)) return false;
        if (measured == PLAN_CANNOT) break;
        pilot->fine_quality = quality;
        note_depths(pilot);
        if (level == 0) continue;
        change = find_change(pilot);
        log_debug("plan: %s, halved %d times: changed by %.2e, %.2e looks", family->name, level, change,
                  pilot->frame_count * looks_of(pilot, &quality));
        if (pilot->start_level < 0 && change <= tolerance) pilot->start_level = level - 1;
        if (level >= LEVEL_MIN && change <= enough) break;
    }
    if (pilot->start_level < 0) pilot->start_level = level > 0 ? level - 1 : 0;
    pilot->fault = RENDERER_FAULT_NONE;
    return true;
}

static bool measure_frame(struct plan_pilot *pilot, struct pilot_frame *frame)
{
    struct truth *truth = truth_open(&(struct truth_params){.job = &pilot->job, .frame = frame->number}, &pilot->error);
    double rms = sqrt(squared_difference(pilot, &frame->fine, NULL));
    double wanted = ACCURACY_SHARE * pilot->params.job->quality.tolerance;
    const struct integrate_accuracy accuracy = {.relative = fmin(fmax(wanted, ACCURACY_MIN), ACCURACY_MAX),
                                                .floor = fmax(DARK_SHARE * rms, BLACK)};
    struct audit_map map;
    size_t count = TRUE_PIXELS;

    if (!truth) {
        pilot->fault = RENDERER_FAULT_FRAME;
        return false;
    }
    audit_map_init(&map, &(struct audit_map_params){.image = &frame->fine,
                                                    .pixel = JOB_PIXEL_FLOAT,
                                                    .finer = &frame->fine,
                                                    .coarser = &frame->before,
                                                    .is_own = true});
    audit_map_draw(&map, &pilot->job, frame->number, 0, count, frame->places);
    for (size_t k = 0; k < count; k++)
        frame->density[k] = audit_map_density(&map, frame->places[k]);
    audit_map_finish(&map);
    frame->true_count = truth_measure_many(truth, &(struct truth_many){.places = frame->places,
                                                                       .pixels = frame->truth,
                                                                       .count = count,
                                                                       .accuracy = &accuracy,
                                                                       .on_progress = on_pixel,
                                                                       .user = pilot});
    truth_close(truth);
    if (frame->true_count == count) return true;
    pilot->fault = RENDERER_FAULT_STOPPED;
    error_set(&pilot->error, "the frame was stopped");
    return false;
}

static const float *seen_at(const struct plan_pilot *pilot, const struct image *image, struct truth_place place)
{
    return &image->rgba[4 * ((size_t)place.y * (size_t)pilot->job.width_px + (size_t)place.x)];
}

// The mean of |I - R|^2: that of |I - F|^2 over all pixels, F being the finest render, and what the pixels of known light
// say of the rest. Of F alone where none is known.
static double square_error(const struct plan_pilot *pilot, const struct pilot_frame *frame, const struct image *image)
{
    double near = squared_difference(pilot, image, &frame->fine), rest = 0.0;

    for (size_t k = 0; k < frame->true_count; k++) {
        const float *seen = seen_at(pilot, image, frame->places[k]);
        const float *fine = seen_at(pilot, &frame->fine, frame->places[k]);
        double sum = 0.0;

        for (int c = 0; c < 3; c++) {
            double light = frame->truth[k].rgb[c];

            sum += ((seen[c] - light) * (seen[c] - light) - (seen[c] - fine[c]) * (seen[c] - fine[c])) / 3.0;
        }
        rest += sum / frame->density[k];
    }
    if (frame->true_count == 0) return near;
    // A few pixels may say that less is left than nothing.
    return fmax(near + rest / (double)frame->true_count, 0.1 * near);
}

static bool init_frames(struct plan_pilot *pilot, const struct plan_segment *segment)
{
    const struct job *job = &pilot->job;

    pilot->frame_count = segment->pilot_count;
    for (int i = 0; i < segment->pilot_count; i++) {
        struct pilot_frame *frame = &pilot->frames[i];
        struct image *const images[] = {&frame->fine, &frame->before, &frame->seen};

        frame->number = segment->pilot[i];
        for (int k = 0; k < 3; k++)
            if (!image_init(images[k], job->width_px, job->height_px, job->output.has_depth,
                            job->output.has_transmittance, &pilot->error))
                return false;
    }
    return true;
}

static bool prepare(struct plan_pilot *pilot)
{
    pilot->fault = RENDERER_FAULT_FRAME;
    if (!init_frames(pilot, &pilot->params.segment) || !make_fine(pilot)) return false;
    for (int i = 0; i < pilot->frame_count; i++) {
        struct pilot_frame *frame = &pilot->frames[i];

        if (pilot->has_truth && !measure_frame(pilot, frame)) return false;
        frame->mean_square = squared_difference(pilot, &frame->fine, NULL);
    }
    return true;
}

struct plan_pilot *plan_pilot_create(const struct plan_pilot_params *params, enum renderer_fault *fault,
                                     struct error *error)
{
    struct plan_pilot *pilot = xcalloc(1, sizeof *pilot);

    pilot->params = *params;
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
    for (int i = 0; i < PLAN_PILOT_LIMIT; i++) {
        image_finish(&pilot->frames[i].fine);
        image_finish(&pilot->frames[i].before);
        image_finish(&pilot->frames[i].seen);
    }
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

double plan_pilot_count_looks(const struct plan_pilot *pilot)
{
    return pilot->looks;
}

enum plan_measured plan_pilot_measure(struct plan_pilot *pilot, const struct job_quality *quality, int only,
                                      struct plan_errors *errors)
{
    double sum = 0.0;
    int count = 0;

    *errors = (struct plan_errors){0};
    for (int i = 0; i < pilot->frame_count; i++) {
        struct pilot_frame *frame = &pilot->frames[i];
        enum plan_measured measured;
        double error;

        if (only != PLAN_ALL_FRAMES && i != only) continue;
        measured = render(pilot, quality, frame->number, &frame->seen);

        if (measured != PLAN_MEASURED) return measured;
        pilot->looks += looks_of(pilot, quality);
        error = relative(square_error(pilot, frame, &frame->seen), frame->mean_square);
        if (isnan(error)) error = INFINITY;
        if (error > errors->largest) errors->worst = i;
        errors->largest = fmax(errors->largest, error);
        sum += error * error;
        count++;
    }
    errors->mean = sqrt(sum / count);
    return PLAN_MEASURED;
}

enum renderer_fault plan_pilot_fault(const struct plan_pilot *pilot, struct error *error)
{
    if (error) *error = pilot->error;
    return pilot->fault;
}

static void fill_pool(const struct plan_pilot *pilot, const struct pilot_frame *frame, struct audit_pool *pool)
{
    double mean_square = squared_difference(pilot, &frame->seen, NULL);
    double change = relative(squared_difference(pilot, &frame->seen, &frame->fine), frame->mean_square);

    if (change > pool->change) pool->change = change;
    for (size_t k = 0; k < frame->true_count; k++) {
        const float *seen = seen_at(pilot, &frame->seen, frame->places[k]);
        double weight = 1.0 / (3.0 * frame->density[k] * (mean_square > BLACK * BLACK ? mean_square : 1.0));
        struct audit_sample sample = {0};

        for (int c = 0; c < 3; c++) {
            double value = image_exr_stored(seen[c], pilot->job.output.pixel);
            double apart = value - frame->truth[k].rgb[c];

            sample.square += weight * apart * apart;
            sample.cross += weight * value * apart;
        }
        audit_samples_append(&pool->samples, &sample);
    }
}

void plan_pilot_give(struct plan_pilot *pilot, struct plan_evidence *evidence)
{
    for (int i = 0; i < pilot->frame_count; i++) {
        struct pilot_frame *frame = &pilot->frames[i];

        fill_pool(pilot, frame, &evidence->pool);
        evidence->views[i] = (struct plan_view){.frame = frame->number, .finer = frame->fine, .coarser = frame->seen};
        frame->fine = frame->seen = (struct image){0};
    }
    evidence->view_count = pilot->frame_count;
}
