// A retry of frames as clients ask for it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/schedule/queue.h"
#include "daemon/schedule/queue_search.h"

#include <stdlib.h>

// The number of frames that are queued again.
static inline int64_t retry_frames(struct queue_job *job, unsigned states, const char *range)
{
    struct frame_set numbers = {0}, indices;
    int64_t found, queued;

    if (range && !frame_set_parse(&numbers, range, NULL)) abort();
    found = queue_search_frames(job, states, range ? &numbers : NULL, &indices);
    queued = queue_retry(job, &indices, 0, indices.limit, false);
    frame_set_finish(&indices);
    frame_set_finish(&numbers);
    return queued == found ? queued : -1;
}
