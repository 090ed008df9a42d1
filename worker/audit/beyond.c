// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/beyond.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "reference/path_scene.h"
#include "reference/paths.h"
#include "reference/stream.h"
#include "worker/audit/beyond_estimate.h"
#include "worker/audit/truth.h"
#include "worker/audit/truth_files.h"
#include "worker/scene/pixel_samples.h"
#include "worker/scene/scene_inputs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum {
    FRAMES_MOST = 3,
    TRIALS = 32,
    TRIAL_PATHS = 2,
    PIXELS_LEAST = 64,
    PIXELS_MOST = 1024,
    HALF_LEAST = 8,
    HALF_MOST = 64
};

static const double TRIAL_SHARE = 0.25;  // of the draws that are allowed: for the trials' paths
static const double SAFETY = 0.8;        // of what is left: the draws that are expected
static const double VOXEL_DRAWS = 0.35;  // that take as long as reading a voxel
static const double FRAME_DRAWS = 1e5;   // for each frame that is looked at, where it is not one alone
static const double READING_SHARE = 0.5; // of the draws: for reading files
static const char TOO_MUCH[] = "measuring it takes too much work";
static const uint64_t TRIAL_SEED = 0x62f7b1c94d3e5a08u, SEED = 0x9d1c6e3b8a5f2471u;

struct measuring {
    const struct beyond_params *params;
    struct truth_files files;
    struct still *stills; // owned, as are the paths; one for each frame
    struct paths *paths[FRAMES_MOST];
    int first, frame_count; // of the frames that are looked at
    double left;            // draws
    int pixels, half;       // to be measured; paths of each half of a pixel
    struct job_beyond *beyond;
    bool is_stopped;
};

static void say(struct job_beyond *beyond, const char *why)
{
    snprintf(beyond->why, sizeof beyond->why, "%.*s", (int)sizeof beyond->why - 1, why);
}

static bool reads_sequence(const struct job *job)
{
    for (size_t i = 0; i < job->scene.medium_count; i++)
        if (job->scene.media[i].density.kind == SCENE_DENSITY_GRID &&
            scene_density_is_sequence(&job->scene.media[i].density))
            return true;
    return false;
}

static bool scatters(const struct still *still)
{
    if (still->objects.count > 0) return true;
    for (size_t i = 0; i < still->medium_count; i++)
        for (int c = 0; c < 3; c++)
            if (still->media[i].sigma_s[c] > 0.0) return true;
    return false;
}

bool beyond_needs_paths(const struct job *job, int32_t frame, struct job_beyond *beyond)
{
    struct still *still = xcalloc(1, sizeof *still);
    struct error error = {{0}};

    *beyond = (struct job_beyond){0};
    if (job->scene.orders == SCENE_ORDERS_ALL) {
        free(still);
        return false;
    }
    still_init(still, job, pixel_samples_middle(job, frame));
    if (job->scene.medium_count == 0)
        say(beyond, "the scene has no media");
    else if (!truth_has_twin(job))
        say(beyond, "a density in GLSL has no twin in the reference");
    else
        beyond->is_known = !scatters(still);
    // Only surfaces are known without files.
    still->medium_count = 0;
    if (!job_beyond_is_told(beyond) && !path_scene_is_possible(still, &error)) say(beyond, error.message);
    free(still);
    return !job_beyond_is_told(beyond);
}

static double count_voxels(const struct job *job, int32_t frame)
{
    struct scene_inputs inputs = {0};
    double sum = 0.0;

    if (!scene_inputs_open(&inputs, job, frame, NULL, NULL, NULL)) return 0.0;
    for (size_t i = 0; i < job->scene.medium_count; i++) {
        const int *size = inputs.media[i].header.size;

        if (inputs.media[i].source) sum += (double)size[0] * size[1] * size[2];
    }
    scene_inputs_finish(&inputs);
    return sum;
}

// Chooses as many frames as the draws allow, for bounding each one's densities takes time that is not counted. False:
// reading the files would take too much.
static bool afford_frames(struct measuring *measuring)
{
    const struct beyond_params *params = measuring->params;
    int count = params->frame_count < FRAMES_MOST ? params->frame_count : FRAMES_MOST, middle = (count - 1) / 2;
    bool is_one = reads_sequence(params->job) || measuring->left < FRAME_DRAWS * count;
    double reading = params->inputs ? 0.0 : VOXEL_DRAWS * count_voxels(params->job, params->frames[middle]);

    measuring->first = is_one ? middle : 0;
    measuring->frame_count = is_one ? 1 : count;
    if (reading > READING_SHARE * measuring->left) {
        say(measuring->beyond, TOO_MUCH);
        return false;
    }
    measuring->left -= reading;
    return true;
}

static bool open_frames(struct measuring *measuring)
{
    const struct beyond_params *params = measuring->params;
    const struct job *job = params->job;
    const int32_t *frames = params->frames + measuring->first;
    const struct still_inputs *inputs = params->inputs ? params->inputs : &measuring->files.inputs;
    struct error error = {{0}};

    if (!params->inputs && !truth_files_load(&measuring->files, job, frames[0], &error)) {
        say(measuring->beyond, error.message);
        return false;
    }
    measuring->stills = xcalloc(FRAMES_MOST, sizeof *measuring->stills);
    for (int i = 0; i < measuring->frame_count; i++) {
        still_init_with_inputs(&measuring->stills[i], job, pixel_samples_middle(job, frames[i]), inputs);
        measuring->paths[i] = paths_create(&measuring->stills[i], SCENE_ORDERS_ALL, &error);
        if (measuring->paths[i]) continue;
        say(measuring->beyond, error.message);
        return false;
    }
    return true;
}

// Additive recurrence by the inverse powers of the plastic number, from a random start: evenly spread, whatever the
// count.
static double place(double start, int index, double step, int size_px)
{
    double at = start + step * (double)index;

    return floor((at - floor(at)) * size_px) + 0.5;
}

static bool walk(struct measuring *measuring, int index, uint64_t seed, long count, double most,
                 struct paths_parts *parts)
{
    const struct job *job = measuring->params->job;
    struct stream start = stream_of(measuring->params->seed, 0);
    double x = stream_draw(&start), y = stream_draw(&start);
    const struct paths_parts_params params = {.x = place(x, index, 0.7548776662466927, job->width_px),
                                              .y = place(y, index, 0.5698402909980532, job->height_px),
                                              .modelled = job->scene.orders,
                                              .count = count,
                                              .seed = stream_mix(seed + measuring->params->seed) + (uint64_t)index,
                                              .draws_most = most};
    bool ok = paths_measure_parts(measuring->paths[index % measuring->frame_count], &params, parts);

    measuring->left -= parts->draws;
    return ok;
}

static bool is_wanted(struct measuring *measuring)
{
    const struct beyond_params *params = measuring->params;

    measuring->is_stopped = measuring->is_stopped || (params->on_progress && !params->on_progress(params->user));
    return !measuring->is_stopped;
}

// Finds how many pixels and paths the draws suffice for, from what the trials' paths cost: they count for nothing else.
static void count_pixels(struct measuring *measuring)
{
    double most = TRIAL_SHARE * measuring->left, spent = 0.0, affordable;
    struct paths_parts parts;

    for (int i = 0; i < TRIALS; i++) {
        if (!is_wanted(measuring) || !walk(measuring, i, TRIAL_SEED, TRIAL_PATHS, most - spent, &parts)) return;
        spent += parts.draws;
        if (spent >= most) return;
    }
    affordable = SAFETY * measuring->left / 2.0 * (TRIALS * TRIAL_PATHS) / fmax(spent, 1.0);
    measuring->half = (int)fmin(fmax(affordable / PIXELS_MOST, HALF_LEAST), HALF_MOST);
    measuring->pixels = (int)fmin(affordable / measuring->half, PIXELS_MOST);
}

static bool measure_pixel(struct measuring *measuring, int index, struct beyond_sample *sample)
{
    struct paths_parts halves[2];

    *sample = (struct beyond_sample){0};
    for (int k = 0; k < 2; k++)
        if (!(measuring->left > 0.0) ||
            !walk(measuring, TRIALS + index, SEED + ((uint64_t)k << 32), measuring->half, measuring->left, &halves[k]))
            return false;
    for (int c = 0; c < 3; c++) {
        double a = halves[0].beyond[c], b = halves[1].beyond[c];

        sample->product += a * b / 3.0;
        sample->square += 0.25 * (a + b) * (a + b) / 3.0;
        sample->whole += (halves[0].within[c] + a) * (halves[1].within[c] + b) / 3.0;
    }
    return true;
}

static void conclude(struct measuring *measuring, const struct beyond_sample *samples, int count)
{
    struct beyond_verdict verdict = beyond_estimate(samples, (size_t)count, 2 * measuring->half);

    if (isnan(verdict.error)) {
        say(measuring->beyond, "the frames that were looked at are black");
        return;
    }
    if (verdict.is_noisy) {
        say(measuring->beyond, TOO_MUCH);
        return;
    }
    *measuring->beyond = (struct job_beyond){.is_known = true, .error = verdict.error, .error95 = verdict.error95};
}

static void measure(struct measuring *measuring)
{
    struct beyond_sample *samples = xcalloc(PIXELS_MOST, sizeof *samples);
    int count = 0;

    count_pixels(measuring);
    while (count < measuring->pixels && is_wanted(measuring) && measure_pixel(measuring, count, &samples[count]))
        count++;
    if (count >= PIXELS_LEAST)
        conclude(measuring, samples, count);
    else
        say(measuring->beyond, TOO_MUCH);
    free(samples);
}

bool beyond_measure(const struct beyond_params *params, struct job_beyond *beyond, double *drawn)
{
    struct measuring measuring = {.params = params, .left = params->draws_most, .beyond = beyond};

    if (beyond_needs_paths(params->job, params->frames[0], beyond) && afford_frames(&measuring) &&
        open_frames(&measuring))
        measure(&measuring);
    for (int i = 0; i < measuring.frame_count; i++)
        paths_destroy(measuring.paths[i]);
    truth_files_finish(&measuring.files);
    free(measuring.stills);
    if (drawn) *drawn = params->draws_most - measuring.left;
    return !measuring.is_stopped;
}
