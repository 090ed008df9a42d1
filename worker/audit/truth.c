// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/truth.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/scene/light_rules.h"
#include "reference/paths.h"
#include "reference/reference.h"
#include "reference/trace.h"
#include "worker/audit/truth_files.h"
#include "worker/scene/pixel_samples.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Least numbers of rays where there are rough surfaces: of all samples of a pixel together, and of each sample.
enum { ROUGH_RAYS = 64, ROUGH_RAYS_MIN = 2 };
enum { THREAD_LIMIT = 64 };

static const double LEAST_THROUGHPUT = 1e-6;

// Light of several orders of scattering is the mean of random paths. A few of a pixel's paths, which count for nothing
// else, tell how many each half of its measurement takes.
enum { PATHS_FIRST = 128, PATHS_MIN = 32, PATHS_MAX = 1 << 17 };
static const double PATHS_RELATIVE = 2e-3; // the accuracy where the caller asks for none
static const double PATHS_FLOOR = 5.0;     // times the accuracy's: noise of dark pixels counts less than its cost
static const double PATHS_SHARE = 1.7;     // a half's standard error, relative to the accuracy

struct truth {
    struct job job; // the caller's with other limits of paths; never finished
    int32_t frame;
    bool is_for_plan;
    struct truth_files files;
    bool is_ready;
    bool is_rough;        // some surface is rough: each sample is traced several times
    struct still *stills; // owned; one for each moment at which samples are taken
    size_t still_count;   // 1, or as many as samples
    struct paths **paths; // owned, like the stills; NULL: one order of scattering
};

// Only light of one scattering from lamps without size is known without random paths.
bool truth_is_random(const struct job *job)
{
    for (size_t i = 0; i < job->scene.light_count; i++)
        if (light_rules_of(job->scene.lights[i].kind)->has_size) return true;
    return job->scene.orders != 1;
}

bool truth_has_twin(const struct job *job)
{
    for (size_t i = 0; i < job->scene.medium_count; i++)
        if (job->scene.media[i].density.kind == SCENE_DENSITY_GLSL) return false;
    return true;
}

// True when a surface is rough at some moment of the frame.
static bool has_rough_surfaces(const struct truth *truth)
{
    for (size_t i = 0; i < truth->still_count; i++) {
        const struct objects *objects = &truth->stills[i].objects;

        for (size_t k = 0; k < objects->count; k++) {
            const struct material *material = &objects->list[k].material;
            bool is_matt = material->kind == SCENE_MATERIAL_DIFFUSE && material->specular == 0.0;

            if (!is_matt && material->roughness > 0.0) return true;
        }
    }
    return false;
}

static void drop_moments(struct truth *truth)
{
    for (size_t i = 0; truth->paths && i < truth->still_count; i++)
        paths_destroy(truth->paths[i]);
    free(truth->paths);
    free(truth->stills);
    truth->paths = NULL;
    truth->stills = NULL;
    truth->still_count = 0;
}

static bool make_paths(struct truth *truth, struct error *error)
{
    truth->paths = xcalloc(truth->still_count, sizeof(struct paths *));
    for (size_t i = 0; i < truth->still_count; i++) {
        truth->paths[i] = paths_create(&truth->stills[i], truth->job.scene.orders, error);
        if (!truth->paths[i]) return false;
    }
    return true;
}

static bool stop_moments(struct truth *truth, struct error *error)
{
    int samples = pixel_samples_count(&truth->job);
    bool moves =
        !scene_is_constant(&truth->job.scene) &&
        pixel_samples_time(&truth->job, truth->frame, 0) != pixel_samples_time(&truth->job, truth->frame, samples - 1);

    drop_moments(truth);
    truth->still_count = moves ? (size_t)samples : 1;
    truth->stills = xcalloc(truth->still_count, sizeof *truth->stills);
    for (size_t i = 0; i < truth->still_count; i++)
        still_init_with_inputs(&truth->stills[i], &truth->job, pixel_samples_time(&truth->job, truth->frame, (int)i),
                               &truth->files.inputs);
    truth->is_rough = has_rough_surfaces(truth);
    return !truth_is_random(&truth->job) || make_paths(truth, error);
}

bool truth_seek(struct truth *truth, int32_t frame, struct error *error)
{
    truth->is_ready = false;
    truth->frame = frame;
    if (!truth_files_load(&truth->files, &truth->job, frame, error)) return false;
    truth->is_ready = stop_moments(truth, error);
    return truth->is_ready;
}

struct truth *truth_open(const struct truth_params *params, struct error *error)
{
    struct truth *truth;

    if (!params->functions && !truth_has_twin(params->job)) {
        error_set(error, "a density in GLSL has no twin in the reference");
        return NULL;
    }
    truth = xcalloc(1, sizeof *truth);
    truth->job = *params->job;
    truth->is_for_plan = params->is_for_plan;
    truth->job.quality.max_depth = JOB_DEPTH_LIMIT;
    truth->job.quality.min_throughput = LEAST_THROUGHPUT;
    if (params->functions)
        memcpy(truth->files.inputs.functions, params->functions, sizeof truth->files.inputs.functions);
    if (truth_seek(truth, params->frame, error)) return truth;
    truth_close(truth);
    return NULL;
}

void truth_close(struct truth *truth)
{
    if (!truth) return;
    truth_files_finish(&truth->files);
    drop_moments(truth);
    free(truth);
}

const struct still_inputs *truth_inputs(const struct truth *truth)
{
    return &truth->files.inputs;
}

static uint64_t mix(uint64_t value)
{
    value = (value ^ (value >> 31)) * 0x7fb5d329728ea185u;
    value = (value ^ (value >> 27)) * 0x81dadef4bc2dd44du;
    return value ^ (value >> 33);
}

// The seed of a ray's own random numbers.
static uint64_t seed_of(const struct truth *truth, int x, int y, int sample, int ray)
{
    uint64_t seed = mix(0x9e3779b97f4a7c15u + pixel_samples_frame_seed(&truth->job, truth->frame));

    seed = mix(seed + (uint64_t)x);
    seed = mix(seed + (uint64_t)y);
    return mix(seed + (ROUGH_RAYS + 1) * (uint64_t)sample + (uint64_t)ray);
}

static int count_rays(const struct truth *truth, int samples)
{
    int rays = (ROUGH_RAYS + samples - 1) / samples;

    if (!truth->is_rough) return 1;
    return rays < ROUGH_RAYS_MIN ? ROUGH_RAYS_MIN : rays;
}

// The light of one sample of a pixel.
struct sample {
    double rgb[3], variance[3]; // of single rays
    double half[3];
    bool is_converged;
};

static double greatest_of(const double rgb[static 3])
{
    return fmax(fmax(rgb[0], rgb[1]), rgb[2]);
}

// Paths for each half of a sample, from some paths of the same pixel.
static long count_paths(const struct truth *truth, const struct paths_light *first,
                        const struct integrate_accuracy *accuracy)
{
    double relative = accuracy && accuracy->relative > 0.0 ? accuracy->relative : PATHS_RELATIVE;
    double light = fmax(greatest_of(first->mean), accuracy ? PATHS_FLOOR * accuracy->floor : 0.0);
    double wanted = PATHS_SHARE * relative * light, error = greatest_of(first->error), count;

    if (!(wanted > 0.0)) return PATHS_MIN;
    count = PATHS_FIRST * (error / wanted) * (error / wanted) / pixel_samples_count(&truth->job);
    return (long)fmin(fmax(count, PATHS_MIN), PATHS_MAX);
}

// The seed of one of a sample's means of paths.
static uint64_t seed_of_paths(const struct truth *truth, struct pixel pixel, int sample, int part)
{
    uint64_t seed = seed_of(truth, pixel.x, pixel.y, sample, part);

    return truth->is_for_plan ? mix(seed) : seed;
}

// Two means of paths, independent of each other.
static struct sample measure_paths(const struct truth *truth, struct pixel pixel, int index,
                                   const struct integrate_accuracy *accuracy)
{
    const struct paths *paths = truth->paths[truth->still_count > 1 ? index : 0];
    struct pixel_point point = pixel_samples_point(&truth->job, truth->frame, pixel.x, pixel.y, index);
    struct sample sample = {.is_converged = true};
    struct paths_light first, halves[2];
    long count;

    paths_measure_point(paths, point.x_px, point.y_px, PATHS_FIRST, seed_of_paths(truth, pixel, index, 2), &first);
    count = count_paths(truth, &first, accuracy);
    for (int i = 0; i < 2; i++)
        paths_measure_point(paths, point.x_px, point.y_px, count, seed_of_paths(truth, pixel, index, i), &halves[i]);
    for (int c = 0; c < 3; c++) {
        sample.rgb[c] = 0.5 * (halves[0].mean[c] + halves[1].mean[c]);
        sample.half[c] = 0.5 * (halves[0].mean[c] - halves[1].mean[c]);
    }
    return sample;
}

static struct sample measure_sample(const struct truth *truth, struct pixel pixel, int index,
                                    const struct integrate_accuracy *accuracy)
{
    const struct still *still = &truth->stills[truth->still_count > 1 ? index : 0];
    struct pixel_point point = pixel_samples_point(&truth->job, truth->frame, pixel.x, pixel.y, index);
    struct ray ray = camera_pinhole_ray(&still->camera, point.x_px, point.y_px);
    int rays = count_rays(truth, pixel_samples_count(&truth->job));
    struct sample sample = {.is_converged = true};
    double squares[3] = {0.0}; // about the mean; Welford, Technometrics 4, 1962

    for (int k = 0; k < rays; k++) {
        struct trace_result traced = trace_ray(still, &ray, seed_of(truth, pixel.x, pixel.y, index, k), accuracy);

        sample.is_converged = sample.is_converged && traced.is_converged;
        for (int c = 0; c < 3; c++) {
            double off = traced.radiance[c] - sample.rgb[c];

            sample.rgb[c] += off / (k + 1);
            squares[c] += off * (traced.radiance[c] - sample.rgb[c]);
        }
    }
    for (int c = 0; c < 3 && rays > 1; c++)
        sample.variance[c] = squares[c] / (rays - 1);
    return sample;
}

static struct truth_pixel mean_of(const struct truth *truth, const struct sample *samples)
{
    int count = pixel_samples_count(&truth->job);
    struct truth_pixel pixel = {.is_converged = true, .share = 1.0 / count_rays(truth, count)};

    for (int i = 0; i < count; i++) {
        pixel.is_converged = pixel.is_converged && samples[i].is_converged;
        for (int c = 0; c < 3; c++) {
            pixel.rgb[c] += samples[i].rgb[c] / count;
            pixel.variance[c] += samples[i].variance[c] / ((double)count * count);
            pixel.half[c] += samples[i].half[c] / count;
        }
    }
    return pixel;
}

struct truth_pixel truth_measure(const struct truth *truth, int x, int y, const struct integrate_accuracy *accuracy)
{
    struct pixel point = {x, y};
    struct truth_pixel pixel;

    truth_measure_many(
        truth,
        &(struct truth_many){.points = &point, .pixels = &pixel, .count = 1, .accuracy = accuracy, .thread_count = 1});
    return pixel;
}

// Shared by the measuring threads. Each takes samples, not pixels: a few pixels keep all of them busy.
struct measuring {
    const struct truth *truth;
    const struct truth_many *many;
    struct sample *samples; // of all pixels, one after the other
    size_t count;           // of samples
    atomic_size_t next;     // the first sample that no thread has taken
    atomic_bool is_stopped;
};

static bool measure_next(struct measuring *measuring)
{
    const struct truth_many *many = measuring->many;
    size_t each = (size_t)pixel_samples_count(&measuring->truth->job), i;

    if (atomic_load(&measuring->is_stopped)) return false;
    i = atomic_fetch_add(&measuring->next, 1);
    if (i >= measuring->count) return false;
    measuring->samples[i] = (measuring->truth->paths ? measure_paths : measure_sample)(
        measuring->truth, many->points[i / each], (int)(i % each), many->accuracy);
    return true;
}

static void *measure_all(void *user)
{
    while (measure_next(user))
        continue;
    return NULL;
}

static int count_threads(const struct measuring *measuring)
{
    int wanted = measuring->many->thread_count;
    long count = wanted > 0 ? wanted : sysconf(_SC_NPROCESSORS_ONLN);

    if (count > (long)measuring->count) count = (long)measuring->count;
    return count > THREAD_LIMIT ? THREAD_LIMIT : (int)count;
}

static bool tell(const struct measuring *measuring)
{
    const struct truth_many *many = measuring->many;

    if (many->done) *many->done = fmin((double)atomic_load(&measuring->next) / (double)measuring->count, 1.0);
    return !many->on_progress || many->on_progress(many->user);
}

static void measure_samples(struct measuring *measuring)
{
    pthread_t threads[THREAD_LIMIT];
    int wanted = count_threads(measuring) - 1, started = 0;

    // A thread that does not start leaves its share to the others.
    while (started < wanted && pthread_create(&threads[started], NULL, measure_all, measuring) == 0)
        started++;
    while (measure_next(measuring)) {
        if (!tell(measuring)) atomic_store(&measuring->is_stopped, true);
    }
    for (int i = 0; i < started; i++)
        (void)pthread_join(threads[i], NULL);
}

size_t truth_measure_many(const struct truth *truth, const struct truth_many *many)
{
    size_t each = (size_t)pixel_samples_count(&truth->job), taken, measured;
    struct measuring measuring = {.truth = truth, .many = many, .count = many->count * each};

    if (!truth->is_ready) {
        memset(many->pixels, 0, many->count * sizeof many->pixels[0]);
        return many->count;
    }
    measuring.samples = xcalloc(measuring.count, sizeof measuring.samples[0]);
    measure_samples(&measuring);
    taken = atomic_load(&measuring.next);
    measured = taken < measuring.count ? taken / each : many->count;
    for (size_t i = 0; i < measured; i++)
        many->pixels[i] = mean_of(truth, &measuring.samples[i * each]);
    free(measuring.samples);
    return measured;
}
