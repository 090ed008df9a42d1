// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/hand.h"

#include "core/base/alloc.h"

#include <stdlib.h>
#include <string.h>

void hand_finish(struct hand *hand)
{
    free(hand->frames);
    *hand = (struct hand){0};
}

void hand_add(struct hand *hand, const struct queue_ticket *ticket)
{
    hand->frames = xgrow(hand->frames, &hand->capacity, hand->count + 1, sizeof hand->frames[0]);
    hand->frames[hand->count++] = (struct hand_frame){.ticket = *ticket};
}

// Answers come in the order the frames were given, so the first is nearly always it.
struct hand_frame *hand_find(const struct hand *hand, int64_t job, int32_t frame, int32_t attempt)
{
    for (size_t i = 0; i < hand->count; i++) {
        const struct queue_ticket *ticket = &hand->frames[i].ticket;

        if (ticket->frame == frame && ticket->job == job && ticket->attempt == attempt) return &hand->frames[i];
    }
    return NULL;
}

void hand_render(struct hand *hand, struct hand_frame *frame)
{
    if (frame->is_rendered) return;
    frame->is_rendered = true;
    hand->rendered_count++;
}

void hand_remove(struct hand *hand, struct hand_frame *frame)
{
    size_t index = (size_t)(frame - hand->frames);

    if (frame->is_rendered) hand->rendered_count--;
    hand->count--;
    memmove(frame, frame + 1, (hand->count - index) * sizeof *frame);
}

const struct hand_frame *hand_current(const struct hand *hand)
{
    for (size_t i = 0; i < hand->count; i++) {
        if (!hand->frames[i].is_rendered) return &hand->frames[i];
    }
    return hand->count > 0 ? hand->frames : NULL;
}

int64_t hand_current_job(const struct hand *hand)
{
    const struct hand_frame *frame = hand_current(hand);

    return frame ? frame->ticket.job : 0;
}

bool hand_holds_job(const struct hand *hand, int64_t job)
{
    for (size_t i = 0; i < hand->count; i++) {
        if (hand->frames[i].ticket.job == job) return true;
    }
    return false;
}
