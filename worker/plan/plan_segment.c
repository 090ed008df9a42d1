// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_segment.h"

#include "core/job/job.h"
#include "core/scene/scene.h"

#include <assert.h>

int64_t plan_segment_count(const struct job *job)
{
    return (frame_range_count(&job->frames) + PLAN_SEGMENT_FRAMES - 1) / PLAN_SEGMENT_FRAMES;
}

static void add_pilot(struct plan_segment *segment, int32_t frame)
{
    int at = segment->pilot_count;

    for (int i = 0; i < at; i++)
        if (segment->pilot[i] == frame) return;
    for (; at > 0 && segment->pilot[at - 1] > frame; at--)
        segment->pilot[at] = segment->pilot[at - 1];
    segment->pilot[at] = frame;
    segment->pilot_count++;
}

struct plan_segment plan_segment_at(const struct job *job, int64_t index)
{
    int64_t count = frame_range_count(&job->frames), first = index * PLAN_SEGMENT_FRAMES;
    struct plan_segment segment = {.index = index, .first = first};

    assert(index >= 0 && first < count);
    segment.count = count - first < PLAN_SEGMENT_FRAMES ? count - first : PLAN_SEGMENT_FRAMES;
    add_pilot(&segment, frame_range_at(&job->frames, first));
    add_pilot(&segment, frame_range_at(&job->frames, first + (segment.count - 1) / 2));
    add_pilot(&segment, frame_range_at(&job->frames, first + segment.count - 1));
    return segment;
}

struct plan_segment plan_segment_of(const struct job *job, int32_t frame)
{
    int64_t index = frame_range_index(&job->frames, frame);

    return plan_segment_at(job, index < 0 ? 0 : index / PLAN_SEGMENT_FRAMES);
}

double plan_segment_pictures(const struct job *job, const struct plan_segment *segment)
{
    return scene_is_constant(&job->scene) ? 1.0 : (double)segment->count;
}
