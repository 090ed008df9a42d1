// A retry of frames as clients ask for it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/schedule/queue.h"
#include "daemon/schedule/queue_search.h"

#include <stdlib.h>

// The number of frames that are queued again.
static inline int64_t retry_frames(struct queue *queue, struct queue_job *job, unsigned states,
                                   const struct frame_range *range)
{
    int32_t *indices;
    size_t count = queue_search_frames(job, states, range, &indices);

    queue_retry(queue, job, indices, count);
    free(indices);
    return (int64_t)count;
}
