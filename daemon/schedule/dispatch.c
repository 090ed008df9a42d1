// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/dispatch.h"

#include <assert.h>
#include <math.h>

#define DEFAULT_OVERHEAD_S 1e-3
// The share of time that assignments may cost: a fifth of the 1 % that all overhead of the farm may cost.
#define OVERHEAD_SHARE 0.002

static size_t chunk_for_overhead(double frame_s, double overhead_s)
{
    double chunk = ceil(overhead_s / (OVERHEAD_SHARE * frame_s));

    if (!(chunk >= 1)) return 1;
    return chunk < DISPATCH_CHUNK_LIMIT ? (size_t)chunk : DISPATCH_CHUNK_LIMIT;
}

size_t dispatch_count(const struct dispatch_load *load)
{
    int64_t share;
    size_t chunk = 1;
    double in_flight;

    assert(load->workers >= 1);
    if (load->left <= 0) return 0;
    if (load->frame_s > 0)
        chunk = chunk_for_overhead(load->frame_s, load->overhead_s > 0 ? load->overhead_s : DEFAULT_OVERHEAD_S);
    // A chunk is at most half of an equal share of what is left, so that chunks shrink and all workers end together.
    share = (load->left + 2 * (int64_t)load->workers - 1) / (2 * (int64_t)load->workers);
    if ((int64_t)chunk > share) chunk = (size_t)share;
    in_flight = (double)load->in_flight;
    if (load->other_jobs_s > 0) in_flight += load->frame_s > 0 ? ceil(load->other_jobs_s / load->frame_s) : 1;
    if (2 * in_flight > (double)chunk) return 0;
    chunk -= (size_t)in_flight;
    return (int64_t)chunk < load->left ? chunk : (size_t)load->left;
}
