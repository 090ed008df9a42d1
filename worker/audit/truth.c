// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/truth.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "reference/reference.h"
#include "reference/trace.h"
#include "worker/audit/truth_files.h"
#include "worker/scene/pixel_samples.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Least numbers of rays where there are rough surfaces: of all samples of a pixel together, and of each sample.
enum { ROUGH_RAYS = 64, ROUGH_RAYS_MIN = 2 };
enum { THREAD_LIMIT = 64 };

static const double LEAST_THROUGHPUT = 1e-6;

struct truth {
    struct job job; // the caller's with other limits of paths; never finished
    int32_t frame;
    struct truth_files files;
    bool is_ready;
    bool is_rough;        // some surface is rough: each sample is traced several times
    struct still *stills; // owned; one for each moment at which samples are taken
    size_t still_count;   // 1, or as many as samples
};

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

static void stop_moments(struct truth *truth)
{
    int samples = pixel_samples_count(&truth->job);
    bool moves =
        !scene_is_constant(&truth->job.scene) &&
        pixel_samples_time(&truth->job, truth->frame, 0) != pixel_samples_time(&truth->job, truth->frame, samples - 1);

    free(truth->stills);
    truth->still_count = moves ? (size_t)samples : 1;
    truth->stills = xcalloc(truth->still_count, sizeof *truth->stills);
    for (size_t i = 0; i < truth->still_count; i++)
        still_init_with_inputs(&truth->stills[i], &truth->job, pixel_samples_time(&truth->job, truth->frame, (int)i),
                               &truth->files.inputs);
    truth->is_rough = has_rough_surfaces(truth);
}

bool truth_seek(struct truth *truth, int32_t frame, struct error *error)
{
    truth->is_ready = false;
    truth->frame = frame;
    if (!truth_files_load(&truth->files, &truth->job, frame, error)) return false;
    stop_moments(truth);
    truth->is_ready = true;
    return true;
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
    free(truth->stills);
    free(truth);
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

struct truth_pixel truth_measure(const struct truth *truth, int x, int y, const struct integrate_accuracy *accuracy)
{
    int samples = pixel_samples_count(&truth->job), rays = count_rays(truth, samples);
    struct truth_pixel pixel = {.is_converged = truth->is_ready, .share = 1.0 / rays};

    for (int i = 0; truth->is_ready && i < samples; i++) {
        const struct still *still = &truth->stills[truth->still_count > 1 ? i : 0];
        struct pixel_point point = pixel_samples_point(&truth->job, truth->frame, x, y, i);
        struct ray ray = camera_pinhole_ray(&still->camera, point.x_px, point.y_px);
        double mean[3] = {0.0}, squares[3] = {0.0}; // about the mean; Welford, Technometrics 4, 1962

        for (int k = 0; k < rays; k++) {
            struct trace_result traced = trace_ray(still, &ray, seed_of(truth, x, y, i, k), accuracy);

            pixel.is_converged = pixel.is_converged && traced.is_converged;
            for (int c = 0; c < 3; c++) {
                double off = traced.radiance[c] - mean[c];

                mean[c] += off / (k + 1);
                squares[c] += off * (traced.radiance[c] - mean[c]);
            }
        }
        for (int c = 0; c < 3; c++) {
            pixel.rgb[c] += mean[c] / samples;
            if (rays > 1) pixel.variance[c] += squares[c] / (rays - 1) / ((double)samples * samples);
        }
    }
    return pixel;
}

// Shared by the measuring threads.
struct measuring {
    const struct truth *truth;
    const struct truth_many *many;
    atomic_size_t next; // the first point that no thread has taken
    atomic_bool is_stopped;
};

static bool measure_next(struct measuring *measuring)
{
    const struct truth_many *many = measuring->many;
    size_t i;

    if (atomic_load(&measuring->is_stopped)) return false;
    i = atomic_fetch_add(&measuring->next, 1);
    if (i >= many->count) return false;
    many->pixels[i] = truth_measure(measuring->truth, many->points[i].x, many->points[i].y, many->accuracy);
    return true;
}

static void *measure_all(void *user)
{
    while (measure_next(user))
        continue;
    return NULL;
}

static int count_threads(const struct truth_many *many)
{
    long count = many->thread_count > 0 ? many->thread_count : sysconf(_SC_NPROCESSORS_ONLN);

    if (count > (long)many->count) count = (long)many->count;
    return count > THREAD_LIMIT ? THREAD_LIMIT : (int)count;
}

size_t truth_measure_many(const struct truth *truth, const struct truth_many *many)
{
    struct measuring measuring = {.truth = truth, .many = many};
    pthread_t threads[THREAD_LIMIT];
    int wanted = count_threads(many) - 1, started = 0;
    size_t taken;

    // A thread that does not start leaves its share to the others.
    while (started < wanted && pthread_create(&threads[started], NULL, measure_all, &measuring) == 0)
        started++;
    while (measure_next(&measuring)) {
        if (many->on_progress && !many->on_progress(many->user)) atomic_store(&measuring.is_stopped, true);
    }
    for (int i = 0; i < started; i++)
        (void)pthread_join(threads[i], NULL);
    taken = atomic_load(&measuring.next);
    return taken < many->count ? taken : many->count;
}
