// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/estimate.h"

#include <math.h>
#include <string.h>

// A frame of no measurable time counts as this, since 0 means "unknown".
#define SHORTEST_S 1e-6f
#define LONGEST_S 1e9
// Of the frames that are left: the weight that they have at the least, for predictions may be off.
#define LEAST_LEFT 0.1

void estimate_add(struct estimate *estimate, double seconds)
{
    if (!(seconds >= 0 && seconds < LONGEST_S)) return;
    estimate->recent_s[estimate->next] = fmaxf((float)seconds, SHORTEST_S);
    estimate->next = (uint8_t)((estimate->next + 1) % ESTIMATE_RECENT);
    if (estimate->count < ESTIMATE_RECENT) estimate->count++;
    estimate->is_current = false;
    estimate->skip_run = 0;
}

// The mean of the first values, then one that moves by a sixteenth.
static float move_mean(float mean, double value, uint8_t *count)
{
    enum { MEMORY = 16 };

    if (*count < MEMORY) ++*count;
    return mean + ((float)value - mean) / (float)*count;
}

void estimate_add_pace(struct estimate *estimate, double seconds, double weight)
{
    uint8_t count = estimate->pace_count;

    if (!(seconds >= 0 && seconds < LONGEST_S)) return;
    estimate->pace_s = move_mean(estimate->pace_s, seconds, &estimate->pace_count);
    estimate->pace_weight = move_mean(estimate->pace_weight, weight, &count);
    estimate->carried += 1.0 - weight;
}

void estimate_add_first(struct estimate *estimate, double seconds, double told_s, double weight)
{
    estimate_add_pace(estimate, fmin(seconds, told_s), weight);
}

void estimate_add_plan(struct estimate *estimate, double seconds, int64_t frame_count)
{
    if (!(seconds >= 0 && seconds < LONGEST_S) || frame_count <= 0) return;
    estimate->plan_s = move_mean(estimate->plan_s, seconds, &estimate->plan_count);
    if (frame_count > estimate->planned_count) estimate->planned_count = frame_count; // the last segment may be short
}

void estimate_foretell(struct estimate *estimate, double seconds)
{
    if (seconds > 0 && seconds < LONGEST_S) estimate->foretold_s = (float)seconds;
}

void estimate_add_skip(struct estimate *estimate, double seconds)
{
    if (!(seconds >= 0 && seconds < LONGEST_S)) return;
    estimate->skip_s = move_mean(estimate->skip_s, seconds, &estimate->skip_count);
    if (estimate->skip_run < UINT32_MAX) estimate->skip_run++;
}

void estimate_end_skips(struct estimate *estimate)
{
    estimate->skip_run = 0;
}

size_t estimate_count(const struct estimate *estimate)
{
    return estimate->count;
}

static float find_median(const struct estimate *estimate)
{
    float sorted[ESTIMATE_RECENT];
    size_t count = estimate->count;

    for (size_t i = 0; i < count; i++) {
        size_t at = i;

        while (at > 0 && sorted[at - 1] > estimate->recent_s[i])
            at--;
        memmove(&sorted[at + 1], &sorted[at], (i - at) * sizeof sorted[0]);
        sorted[at] = estimate->recent_s[i];
    }
    return count % 2 ? sorted[count / 2] : (sorted[count / 2 - 1] + sorted[count / 2]) / 2;
}

double estimate_median_s(struct estimate *estimate)
{
    if (estimate->count == 0) return 0;
    if (!estimate->is_current) estimate->median_s = find_median(estimate);
    estimate->is_current = true;
    return (double)estimate->median_s;
}

double estimate_each_s(struct estimate *estimate)
{
    return estimate->count > 0 ? estimate_median_s(estimate) : (double)estimate->foretold_s;
}

// A segment is begun when the first of its frames is done.
static int64_t count_plans(const struct estimate *estimate, int64_t total, int64_t left)
{
    int64_t each = estimate->planned_count;

    if (each <= 0) return 0;
    return (total + each - 1) / each - (total - left + each - 1) / each;
}

double estimate_eta_s(struct estimate *estimate, int64_t total, int64_t left, int workers)
{
    int64_t rounds; // the last round counts as a full one
    double each_s;

    if (left <= 0) return 0;
    if (workers < 1 || (estimate->count == 0 && !(estimate->foretold_s > 0))) return -1;
    rounds = (left + workers - 1) / workers;
    each_s = estimate->pace_count > 0 ? (double)estimate->pace_s : estimate_median_s(estimate);
    if (estimate->count == 0) each_s = (double)estimate->foretold_s;
    if (estimate->pace_weight > 0)
        each_s *= fmax(1.0 + estimate->carried / (double)left, LEAST_LEFT) / (double)estimate->pace_weight;
    return each_s * (double)rounds + (double)estimate->plan_s * (double)count_plans(estimate, total, left);
}
