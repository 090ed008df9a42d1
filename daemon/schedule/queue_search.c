// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/queue_search.h"

#include "core/base/alloc.h"
#include "daemon/schedule/queue.h"

#include <stdbool.h>
#include <stdlib.h>

static bool matches(const struct queue_job *job, int64_t index, unsigned states)
{
    unsigned state = job->states[index].state;

    return (states >> state & 1) && state != FRAME_QUEUED && state != FRAME_RUNNING;
}

static int compare_indices(const void *a, const void *b)
{
    int32_t left = *(const int32_t *)a, right = *(const int32_t *)b;

    return (left > right) - (left < right);
}

static size_t search_all(const struct queue_job *job, unsigned states, const struct frame_range *range,
                         int32_t *indices)
{
    size_t count = 0;

    for (int64_t i = 0; i < job->frame_count; i++) {
        if (!matches(job, i, states)) continue;
        if (range && frame_range_index(range, frame_range_at(&job->frames, i)) < 0) continue;
        indices[count++] = (int32_t)i;
    }
    return count;
}

static size_t search_range(const struct queue_job *job, unsigned states, const struct frame_range *range,
                           int32_t *indices)
{
    int64_t wanted = frame_range_count(range);
    size_t count = 0;

    for (int64_t i = 0; i < wanted; i++) {
        int64_t index = frame_range_index(&job->frames, frame_range_at(range, i));

        if (index >= 0 && matches(job, index, states)) indices[count++] = (int32_t)index;
    }
    qsort(indices, count, sizeof indices[0], compare_indices);
    return count;
}

size_t queue_search_frames(const struct queue_job *job, unsigned states, const struct frame_range *range,
                           int32_t **indices)
{
    int64_t most = 0;
    size_t count;

    *indices = NULL;
    for (int state = 0; state < FRAME_STATE_COUNT; state++)
        if (states >> state & 1) most += job->counts[state];
    if (range && frame_range_count(range) < most) most = frame_range_count(range);
    if (most == 0) return 0;
    *indices = xmalloc((size_t)most * sizeof **indices);
    count = range && frame_range_count(range) < job->frame_count ? search_range(job, states, range, *indices)
                                                                 : search_all(job, states, range, *indices);
    if (count > 0) return count;
    free(*indices);
    *indices = NULL;
    return 0;
}
