#include "worker/audit.h"

#include "core/alloc.h"
#include "core/job.h"
#include "worker/audit_map.h"
#include "worker/image.h"
#include "worker/image_exr.h"
#include "worker/truth.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

// Pixels that are measured between two looks at the clock, at most.
enum { BATCH = 64, RAY_MAX_FACTOR = 16 };

// The reference's error beside the tolerance, and how dark a pixel is, beside the frame's RMS, whose error is no longer seen.
static const double REFERENCE_SHARE = 0.05, DARK_SHARE = 0.1;
static const double FINEST = 1e-4, COARSEST = 0.01; // accuracies of the reference
static const double BLACK = 1e-6;                   // below it everywhere a frame counts as black

struct audit {
    const struct audit_params *params;
    struct audit_map map;
    struct audit_samples samples;
    struct integrate_accuracy accuracy;
    double start_s;
    bool is_black, is_stopped;
};

static double now_s(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

void audit_pool_finish(struct audit_pool *pool)
{
    audit_samples_finish(&pool->samples);
    *pool = (struct audit_pool){0};
}

static struct audit_sample compare(const struct audit *audit, struct truth_place place, const struct truth_pixel *pixel)
{
    const struct image *image = audit->params->image;
    const float *seen = &image->rgba[4 * ((size_t)place.y * (size_t)image->width_px + (size_t)place.x)];
    double weight =
        1.0 / (3.0 * audit_map_density(&audit->map, place) * (audit->is_black ? 1.0 : audit->map.mean_square));
    struct audit_sample sample = {0};

    for (int c = 0; c < 3; c++) {
        double value = image_exr_stored(seen[c], audit->map.pixel), apart = value - pixel->rgb[c];

        // The frame's own lot adds its variance, and the reference, a mean of two, half of it.
        sample.square += weight * (apart * apart - 1.5 * pixel->variance[c]);
        sample.cross += weight * value * apart;
        sample.noise += weight * pixel->variance[c];
    }
    return sample;
}

// False when it was stopped.
static bool measure(struct audit *audit, size_t count)
{
    const struct audit_params *params = audit->params;
    struct truth_place places[BATCH];
    struct truth_pixel pixels[BATCH];
    size_t measured;

    audit_map_draw(&audit->map, params->job, params->frame, audit->samples.count, count, places);
    measured = truth_measure_many(params->truth, &(struct truth_many){.places = places,
                                                                      .pixels = pixels,
                                                                      .count = count,
                                                                      .accuracy = &audit->accuracy,
                                                                      .thread_count = params->thread_count,
                                                                      .on_progress = params->on_progress,
                                                                      .user = params->user});
    for (size_t i = 0; i < measured; i++) {
        struct audit_sample sample = compare(audit, places[i], &pixels[i]);

        audit_samples_append(&audit->samples, &sample);
    }
    return measured == count;
}

static struct audit_verdict judge(const struct audit *audit)
{
    const struct audit_pool *pool = audit->params->pool;

    return audit_estimate(&(struct audit_evidence){.own = &audit->samples,
                                                   .pool = pool ? &pool->samples : NULL,
                                                   .change = audit->params->is_own ? audit->map.change : -1.0,
                                                   .pool_change = pool ? pool->change : 0.0,
                                                   .is_black = audit->is_black});
}

// More pixels are worth their time only while it is open on which side of the tolerance the frame is.
static bool is_plain(const struct audit *audit)
{
    struct audit_verdict verdict = judge(audit);

    return verdict.error95 <= audit->params->tolerance || verdict.error > 2.0 * audit->params->tolerance;
}

static void measure_enough(struct audit *audit)
{
    const struct audit_params *params = audit->params;
    int least = params->ray_min > 0 ? params->ray_min : params->pool ? AUDIT_RAYS_POOLED : AUDIT_RAYS_MIN;
    int most = params->ray_max > 0 ? params->ray_max : RAY_MAX_FACTOR * least;

    while (audit->samples.count < (size_t)most) {
        size_t done = audit->samples.count, left = (size_t)(done < (size_t)least ? least : most) - done;
        double spent_s = now_s() - audit->start_s;

        if (done >= (size_t)least) {
            double affordable = (params->budget_s - spent_s) / (spent_s / (double)done);

            if (affordable < 1.0 || is_plain(audit)) break;
            if (affordable < (double)left) left = (size_t)affordable;
        }
        if (!measure(audit, left < BATCH ? left : BATCH)) {
            audit->is_stopped = true;
            break;
        }
    }
}

static void gather(const struct audit *audit, struct audit_pool *pool)
{
    for (size_t i = 0; i < audit->samples.count; i++)
        audit_samples_append(&pool->samples, &audit->samples.list[i]);
    if (audit->params->is_own && audit->map.change > pool->change) pool->change = audit->map.change;
}

static void begin(struct audit *audit, const struct audit_params *params)
{
    double rms;

    *audit = (struct audit){.params = params, .start_s = now_s()};
    audit_map_init(&audit->map, &(struct audit_map_params){.image = params->image,
                                                           .pixel = params->job->output.pixel,
                                                           .finer = params->finer,
                                                           .coarser = params->coarser,
                                                           .is_own = params->is_own});
    rms = sqrt(audit->map.mean_square);
    audit->is_black = rms < BLACK;
    audit->accuracy.relative = fmin(fmax(REFERENCE_SHARE * params->tolerance, FINEST), COARSEST);
    audit->accuracy.floor = isfinite(rms) ? fmax(DARK_SHARE * rms, BLACK) : BLACK;
}

bool audit_frame(const struct audit_params *params, struct audit_result *result)
{
    struct audit audit;
    struct audit_verdict verdict;
    bool is_stopped;

    begin(&audit, params);
    measure_enough(&audit);
    verdict = judge(&audit);
    *result = (struct audit_result){.kind = AUDIT_REFERENCE,
                                    .is_pooled = verdict.is_pooled,
                                    .error = verdict.error,
                                    .error95 = verdict.error95,
                                    .ray_count = (int)verdict.ray_count,
                                    .tolerance = params->tolerance,
                                    .seconds = now_s() - audit.start_s,
                                    .sampling_error = verdict.sampling_error};
    if (params->gathered) gather(&audit, params->gathered);
    is_stopped = audit.is_stopped;
    audit_samples_finish(&audit.samples);
    audit_map_finish(&audit.map);
    return !is_stopped;
}
