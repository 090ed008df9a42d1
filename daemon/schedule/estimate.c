// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/estimate.h"

#include <math.h>
#include <string.h>

// A frame of no measurable time counts as this, since 0 means "unknown".
#define SHORTEST_S 1e-6f
#define LONGEST_S 1e9

void estimate_add(struct estimate *estimate, double seconds)
{
    if (!(seconds >= 0 && seconds < LONGEST_S)) return;
    estimate->recent_s[estimate->next] = fmaxf((float)seconds, SHORTEST_S);
    estimate->next = (uint8_t)((estimate->next + 1) % ESTIMATE_RECENT);
    if (estimate->count < ESTIMATE_RECENT) estimate->count++;
    estimate->is_current = false;
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

double estimate_eta_s(struct estimate *estimate, int64_t left, int workers)
{
    int64_t rounds; // the last round counts as a full one

    if (left <= 0) return 0;
    if (workers < 1 || estimate->count == 0) return -1;
    rounds = (left + workers - 1) / workers;
    return estimate_median_s(estimate) * (double)rounds;
}
