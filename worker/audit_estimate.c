#include "worker/audit_estimate.h"

#include "core/alloc.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

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

struct moments {
    double square, cross, noise; // means
    double deviation;            // of the squares
};

static struct moments find_moments(const struct audit_samples *samples)
{
    struct moments moments = {0};
    double count = (double)samples->count, sum = 0.0;

    for (size_t i = 0; i < samples->count; i++) {
        moments.square += samples->list[i].square / count;
        moments.cross += samples->list[i].cross / count;
        moments.noise += samples->list[i].noise / count;
    }
    for (size_t i = 0; i < samples->count; i++) {
        double off = samples->list[i].square - moments.square;

        sum += off * off;
    }
    moments.deviation = samples->count > 1 ? sqrt(sum / (count - 1.0)) : INFINITY;
    return moments;
}

static double upper_square(const struct audit_samples *samples, const struct moments *moments)
{
    return fmax(moments->square, 0.0) + 3.0 * moments->deviation / sqrt((double)samples->count);
}

// RMS of the light over that of the frame, whose errors' RMS is `error`: by the triangle inequality from 1 - error to 1 + error.
static double light_over_frame(const struct moments *moments, double error)
{
    double estimate = sqrt(fmax(1.0 - 2.0 * moments->cross + moments->square, 0.0));

    return fmin(fmax(estimate, fmax(1.0 - error, 0.1)), 1.0 + error);
}

struct audit_verdict audit_estimate(const struct audit_evidence *evidence)
{
    bool is_pooled = evidence->pool && evidence->pool->count > 0;
    const struct audit_samples *samples = is_pooled ? evidence->pool : evidence->own;
    struct audit_verdict verdict = {.ray_count = samples->count, .is_pooled = is_pooled};
    struct moments moments = find_moments(samples);
    double error = sqrt(fmax(moments.square, 0.0)), upper = sqrt(upper_square(samples, &moments)), light = 1.0;

    if (evidence->change > 0.0) upper = fmax(upper, evidence->change);
    if (!evidence->is_black) light = light_over_frame(&moments, error);
    verdict.error = error / light;
    verdict.error95 = upper / fmin(light, 1.0);
    verdict.sampling_error = sqrt(fmax(moments.noise, 0.0)) / light;
    return verdict;
}
