// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/audit_estimate.h"

#include "core/base/alloc.h"

#include <math.h>
#include <stdlib.h>

// tests/light/audit_coverage_test measures how often the bound holds with these.
static const double LOG_OF_20 = 2.995732273553991; // log(1 / (1 - 0.95))
static const double LEAST_LIGHT = 0.1;             // the light's RMS at least, relative to the frame's
static const double SURE_LIGHT = 0.4;              // the same for error95, relative to the light's estimated RMS
static const double UNLIKE = 2.0; // standard errors above the pool's mean square that make a frame unlike the pool

void audit_samples_append(struct audit_samples *samples, const struct audit_sample *sample)
{
    samples->list = xgrow(samples->list, &samples->capacity, samples->count + 1, sizeof *samples->list);
    samples->list[samples->count++] = *sample;
}

void audit_samples_finish(struct audit_samples *samples)
{
    free(samples->list);
    *samples = (struct audit_samples){0};
}

static const double RANDOM_LARGEST = 2.0; // the largest square of a frame like the pool, relative to the pool's

struct moments {
    size_t count;
    double square, cross, noise; // means
    double deviation, largest;   // of the squares
};

static void add_sums(struct moments *moments, const struct audit_samples *samples)
{
    for (size_t i = 0; i < samples->count; i++) {
        const struct audit_sample *sample = &samples->list[i];

        moments->square += sample->square;
        moments->cross += sample->cross;
        moments->noise += sample->noise;
        moments->largest = fmax(moments->largest, sample->square);
    }
    moments->count += samples->count;
}

static double squares_about(const struct audit_samples *samples, double mean)
{
    double sum = 0.0;

    for (size_t i = 0; i < samples->count; i++)
        sum += (samples->list[i].square - mean) * (samples->list[i].square - mean);
    return sum;
}

// The moments of one list, or of two together.
static struct moments find_moments(const struct audit_samples *a, const struct audit_samples *b)
{
    struct moments moments = {0};
    double sum;

    add_sums(&moments, a);
    if (b) add_sums(&moments, b);
    if (moments.count == 0) return moments;
    moments.square /= (double)moments.count;
    moments.cross /= (double)moments.count;
    moments.noise /= (double)moments.count;
    sum = squares_about(a, moments.square) + (b ? squares_about(b, moments.square) : 0.0);
    moments.deviation = sqrt(sum / fmax((double)moments.count - 1.0, 1.0));
    return moments;
}

static double bernstein_bound(const struct moments *moments)
{
    double count = (double)moments->count;

    if (moments->count < 2) return INFINITY;
    return fmax(moments->square, 0.0) + moments->deviation * sqrt(2.0 * LOG_OF_20 / count) +
           7.0 * LOG_OF_20 * moments->largest / (3.0 * (count - 1.0));
}

// The factor by which the frame's squared error may exceed the pool's.
static double growth_over_pool(const struct audit_evidence *evidence)
{
    double growth = evidence->change / evidence->pool_change;

    return evidence->change > 0.0 && evidence->pool_change > 0.0 && growth > 1.0 ? growth * growth : 1.0;
}

// RMS of the light over the RMS of the frame. `error` is the RMS of the frame's errors: by the triangle inequality the
// ratio is from 1 - error to 1 + error.
static double light_over_frame(const struct moments *moments, double error)
{
    double estimate = sqrt(fmax(1.0 - 2.0 * moments->cross + moments->square, 0.0));

    return fmin(fmax(estimate, fmax(1.0 - error, LEAST_LIGHT)), 1.0 + error);
}

// False where a square of the frame is larger than any of the pool's, or twice as large where squares are random, or
// their mean is larger than chance would make it.
static bool is_like_pool(const struct audit_evidence *evidence, const struct moments *own)
{
    double growth = growth_over_pool(evidence);
    struct moments pool;

    if (!evidence->pool || evidence->pool->count == 0) return false;
    if (own->count == 0 || own->square <= evidence->resolution * evidence->resolution) return true;
    pool = find_moments(evidence->pool, NULL);
    return own->largest <= (evidence->is_random ? RANDOM_LARGEST : 1.0) * growth * pool.largest &&
           own->square <= growth * (pool.square + UNLIKE * pool.deviation / sqrt((double)own->count));
}

// The root of a mean square that is one standard error larger.
static double error_beside(const struct moments *moments, double growth)
{
    double deviation = moments->count > 0 ? moments->deviation / sqrt((double)moments->count) : 0.0;

    return sqrt(growth * (fmax(moments->square, 0.0) + deviation));
}

struct audit_verdict audit_estimate(const struct audit_evidence *evidence)
{
    struct moments moments = find_moments(evidence->own, NULL);
    struct audit_verdict verdict = {.is_pooled = is_like_pool(evidence, &moments)};
    double growth = 1.0, error, upper, light;

    if (verdict.is_pooled) {
        moments = find_moments(evidence->pool, evidence->own);
        growth = growth_over_pool(evidence);
    }
    verdict.ray_count = moments.count;
    // fmax below would ignore NaN.
    if (!isfinite(moments.square)) {
        verdict.error = verdict.error95 = INFINITY;
        return verdict;
    }
    error = sqrt(growth * fmax(moments.square, 0.0));
    upper = sqrt(growth * bernstein_bound(&moments));
    upper = fmax(upper, fmax(evidence->change, evidence->resolution));
    light = evidence->is_black ? 1.0 : light_over_frame(&moments, error);
    verdict.error = error / light;
    verdict.spread = (error_beside(&moments, growth) - error) / light;
    verdict.error95 = upper / (evidence->is_black ? 1.0 : fmin(light, fmax(1.0 - upper, SURE_LIGHT * light)));
    verdict.sampling_error = sqrt(fmax(moments.noise, 0.0)) / light;
    return verdict;
}

void audit_estimate_join(const struct audit_verdict *verdict, double *error, double *spread)
{
    double both = hypot(*error, verdict->error);

    if (both > 0.0) *spread = (*error * *spread + verdict->error * verdict->spread) / both;
    *error = both;
}
