// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/audit.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/job/job.h"
#include "worker/audit/audit_map.h"

#include <math.h>
#include <stdlib.h>

enum {
    BATCH = 64,             // pixels that are measured at once, at most
    RAY_MAX_FACTOR = 16,    // the most pixels, relative to the least,
    REPLACEABLE_FACTOR = 4, // and of a picture that can be replaced;
    BELIEVED_FACTOR = 2     // so many tell that such a picture is over the tolerance
};

// docs/rendering.md has the table of accuracies and times by which these were chosen.
static const double REFERENCE_SHARE = 0.5;          // the accuracy asked of the reference, relative to the tolerance,
static const double FINEST = 1e-4, COARSEST = 0.05; // and its limits
static const double RESOLUTION_SHARE = 0.05;        // the reference's own error then, relative to the tolerance

struct audit {
    const struct audit_params *params;
    struct audit_map map;
    struct audit_samples samples;
    struct integrate_accuracy accuracy;
    size_t batch, batch_done; // pixels that are being measured, and how many of them are known to be
    double start_s;
    bool is_stopped;
};

void audit_pool_finish(struct audit_pool *pool)
{
    audit_samples_finish(&pool->samples);
    *pool = (struct audit_pool){0};
}

static size_t find_least(const struct audit_params *params)
{
    return params->ray_min > 0 ? (size_t)params->ray_min : AUDIT_RAYS_MIN;
}

static size_t find_most(const struct audit_params *params)
{
    if (params->ray_max > 0) return (size_t)params->ray_max;
    return (params->is_replaceable ? REPLACEABLE_FACTOR : RAY_MAX_FACTOR) * find_least(params);
}

// Nobody knows how many pixels it will take: the share grows towards 1.
static bool on_measured(void *user)
{
    struct audit *audit = user;
    const struct audit_params *params = audit->params;
    double measured;

    if (audit->batch_done < audit->batch) audit->batch_done++;
    measured = (double)(audit->samples.count + audit->batch_done);
    return !params->on_progress ||
           params->on_progress(params->user, measured / (measured + 0.25 * (double)find_least(params)));
}

// Measures the next `count` draws. False when it was stopped.
static bool measure(struct audit *audit, size_t count)
{
    const struct audit_params *params = audit->params;
    struct pixel points[BATCH];
    struct truth_pixel pixels[BATCH];
    float traced[4 * BATCH];
    size_t measured;

    audit->batch = count;
    audit->batch_done = 0;
    audit_map_draw(&audit->map, params->job, params->frame, audit->samples.count, count, points);
    if (params->on_trace && !params->on_trace(params->user, points, count, traced)) return false;
    measured = truth_measure_many(params->truth, &(struct truth_many){.points = points,
                                                                      .pixels = pixels,
                                                                      .count = count,
                                                                      .accuracy = &audit->accuracy,
                                                                      .thread_count = params->thread_count,
                                                                      .on_progress = on_measured,
                                                                      .user = audit});
    for (size_t i = 0; i < measured; i++) {
        struct audit_sample sample =
            audit_map_compare(&audit->map, points[i], params->on_trace ? &traced[4 * i] : NULL, &pixels[i]);

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
                                                   .pool_change = pool ? pool->change : -1.0,
                                                   .resolution = RESOLUTION_SHARE * audit->params->tolerance,
                                                   .is_random = truth_is_random(audit->params->job),
                                                   .is_black = audit_map_is_black(&audit->map)});
}

// True when the error is a standard error within the tolerance, or more over it: then more pixels are not worth their
// time.
static bool is_clear(const struct audit *audit, const struct audit_verdict *verdict)
{
    double error = verdict->error, spread = verdict->spread;

    audit_estimate_join(&audit->params->interpolation, &error, &spread);
    if (audit->params->is_replaceable && error > audit->params->tolerance &&
        verdict->ray_count >= BELIEVED_FACTOR * find_least(audit->params))
        return true;
    return fabs(error - audit->params->tolerance) >= spread;
}

// The number of pixels to measure next; 0: there are enough. Their number doubles each time: every verdict may be
// wrong, so there are to be few.
static size_t find_next_count(const struct audit *audit)
{
    const struct audit_params *params = audit->params;
    size_t done = audit->samples.count, least = find_least(params), most = find_most(params);
    size_t wanted = truth_is_random(params->job) ? AUDIT_RAYS_POOLED_RANDOM : AUDIT_RAYS_POOLED;
    size_t pooled = least < wanted ? least : wanted;
    struct audit_verdict verdict;

    if (params->pool && done < pooled) return pooled - done;
    if (done == 0) return least;
    verdict = judge(audit);
    if (!verdict.is_pooled && done < least) return least - done;
    if (is_clear(audit, &verdict) || done >= most) return 0;
    return done < most - done ? done : most - done;
}

static void measure_enough(struct audit *audit)
{
    size_t left;

    while ((left = find_next_count(audit)) > 0) {
        for (size_t count; left > 0 && !audit->is_stopped; left -= count) {
            count = left < BATCH ? left : BATCH;
            audit->is_stopped = !measure(audit, count);
        }
        if (audit->is_stopped) break;
    }
}

static void gather(const struct audit *audit, struct audit_pool *pool)
{
    for (size_t i = 0; i < audit->samples.count; i++)
        audit_samples_append(&pool->samples, &audit->samples.list[i]);
    if (audit->params->is_own && audit->map.change > pool->change) pool->change = audit->map.change;
}

struct integrate_accuracy audit_accuracy(double tolerance, double mean_square)
{
    double rms = sqrt(mean_square);

    return (struct integrate_accuracy){.relative = fmin(fmax(REFERENCE_SHARE * tolerance, FINEST), COARSEST),
                                       .floor = audit_map_floor(isfinite(rms) ? rms : 0.0)};
}

static void begin(struct audit *audit, const struct audit_params *params)
{
    *audit = (struct audit){.params = params, .start_s = clock_now_s()};
    audit_map_init(&audit->map, &(struct audit_map_params){.image = params->image,
                                                           .pixel = params->job->output.pixel,
                                                           .finer = params->finer,
                                                           .coarser = params->coarser,
                                                           .is_own = params->is_own});
    audit->accuracy = audit_accuracy(params->tolerance, audit->map.mean_square);
}

bool audit_frame(const struct audit_params *params, struct audit_result *result)
{
    struct audit_verdict verdict = {.error = INFINITY, .error95 = INFINITY};
    struct audit audit;

    begin(&audit, params);
    if (isfinite(audit.map.mean_square)) {
        measure_enough(&audit);
        verdict = judge(&audit);
        if (params->gathered) gather(&audit, params->gathered);
    }
    *result = (struct audit_result){.kind = AUDIT_REFERENCE,
                                    .is_pooled = verdict.is_pooled,
                                    .error = verdict.error,
                                    .error95 = verdict.error95,
                                    .spread = verdict.spread,
                                    .ray_count = (int)verdict.ray_count,
                                    .tolerance = params->tolerance,
                                    .seconds = clock_now_s() - audit.start_s,
                                    .sampling_error = verdict.sampling_error};
    audit_samples_finish(&audit.samples);
    audit_map_finish(&audit.map);
    return !audit.is_stopped;
}
