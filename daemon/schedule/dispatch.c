// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/dispatch.h"

#include <assert.h>
#include <math.h>

#define DEFAULT_OVERHEAD_S 1e-3
// The share of time that assignments may cost: a fifth of the 1 % that all overhead of the farm may cost.
#define OVERHEAD_SHARE 0.002

static const double SHORTEST_S = 1e-6;

static size_t chunk_for_overhead(double frame_s, double overhead_s)
{
    double chunk = ceil(overhead_s / (OVERHEAD_SHARE * frame_s));

    if (!(chunk >= 1)) return 1;
    return chunk < DISPATCH_CHUNK_LIMIT ? (size_t)chunk : DISPATCH_CHUNK_LIMIT;
}

static size_t find_chunk(const struct dispatch_load *load)
{
    double overhead_s = load->overhead_s > 0 ? load->overhead_s : DEFAULT_OVERHEAD_S;
    size_t chunk;

    if (load->skip_run == 0) return load->frame_s > 0 ? chunk_for_overhead(load->frame_s, overhead_s) : 1;
    chunk = chunk_for_overhead(fmax(load->skip_s, SHORTEST_S), overhead_s);
    return chunk / 2 > load->skip_run ? 2 * load->skip_run : chunk;
}

size_t dispatch_count_fitting(double frame_s, double left_s, size_t in_flight)
{
    double count;

    if (left_s <= 0) return 0;
    if (!(frame_s > 0) || isinf(left_s)) return SIZE_MAX;
    count = floor(left_s / frame_s) - (double)in_flight;
    if (!(count > 0)) return 0;
    return count < DISPATCH_CHUNK_LIMIT ? (size_t)count : DISPATCH_CHUNK_LIMIT;
}

bool dispatch_is_overfull(double frame_s, size_t count)
{
    return count > 2 * (frame_s > 0 ? chunk_for_overhead(frame_s, DEFAULT_OVERHEAD_S) : 1);
}

size_t dispatch_count(const struct dispatch_load *load)
{
    size_t most = load->workers < DISPATCH_LIMIT ? (size_t)(DISPATCH_LIMIT / load->workers) : 1, chunk;
    int64_t share;
    double in_flight;

    assert(load->workers >= 1);
    if (load->left <= 0) return 0;
    chunk = find_chunk(load);
    if (chunk > most) chunk = most;
    // A chunk is at most half of an equal share of what is left, so that chunks shrink and all workers end together.
    share = (load->left + 2 * (int64_t)load->workers - 1) / (2 * (int64_t)load->workers);
    if ((int64_t)chunk > share) chunk = (size_t)share;
    in_flight = (double)load->in_flight;
    if (load->other_jobs_s > 0) in_flight += load->frame_s > 0 ? ceil(load->other_jobs_s / load->frame_s) : 1;
    if (2 * in_flight > (double)chunk) return 0;
    chunk -= (size_t)in_flight;
    return (int64_t)chunk < load->left ? chunk : (size_t)load->left;
}
