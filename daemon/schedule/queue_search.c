// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/queue_search.h"

#include "daemon/schedule/queue.h"

int64_t queue_search_frames(const struct queue_job *job, unsigned states, const struct frame_set *numbers,
                            struct frame_set *indices)
{
    const struct frame_range *frames = &job->frames;
    int64_t count = 0;

    states &= ~(1U << FRAME_QUEUED | 1U << FRAME_RUNNING);
    frame_set_init(indices, frame_range_count(frames));
    for (const struct frame_span *span = frames->spans; span < frames->spans + frames->span_count; span++)
        for (int32_t i = 0; i < span->count; i++) {
            int64_t index = (int64_t)span->before + i;

            if (!(states >> frame_states_get(&job->states, index) & 1)) continue;
            if (numbers && !frame_set_has(numbers, span->first + i * span->step)) continue;
            frame_set_add(indices, index);
            count++;
        }
    return count;
}
