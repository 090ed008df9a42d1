// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/in_flight.h"

#include "core/base/alloc.h"

#include <stdlib.h>
#include <string.h>

void in_flight_finish(struct in_flight *in_flight)
{
    free(in_flight->frames);
    *in_flight = (struct in_flight){0};
}

void in_flight_add(struct in_flight *in_flight, const struct queue_ticket *ticket)
{
    in_flight->frames =
        xgrow(in_flight->frames, &in_flight->capacity, in_flight->count + 1, sizeof in_flight->frames[0]);
    in_flight->frames[in_flight->count++] = (struct in_flight_frame){.ticket = *ticket};
}

// Reports come in the order of assignment, so the first frame matches nearly always.
struct in_flight_frame *in_flight_find(const struct in_flight *in_flight, int64_t job, int32_t frame, int32_t attempt)
{
    for (size_t i = 0; i < in_flight->count; i++) {
        const struct queue_ticket *ticket = &in_flight->frames[i].ticket;

        if (ticket->frame == frame && ticket->job == job && ticket->attempt == attempt) return &in_flight->frames[i];
    }
    return NULL;
}

void in_flight_mark_rendered(struct in_flight *in_flight, struct in_flight_frame *frame)
{
    frame->phase = FRAME_PHASE_ENCODE;
    frame->phase_progress = -1.0;
    if (frame->is_rendered) return;
    frame->is_rendered = true;
    in_flight->rendered_count++;
}

void in_flight_remove(struct in_flight *in_flight, struct in_flight_frame *frame)
{
    size_t index = (size_t)(frame - in_flight->frames);

    if (frame->is_rendered) in_flight->rendered_count--;
    in_flight->count--;
    memmove(frame, frame + 1, (in_flight->count - index) * sizeof *frame);
}

const struct in_flight_frame *in_flight_current(const struct in_flight *in_flight)
{
    for (size_t i = 0; i < in_flight->count; i++) {
        if (!in_flight->frames[i].is_rendered) return &in_flight->frames[i];
    }
    return in_flight->count > 0 ? in_flight->frames : NULL;
}

int64_t in_flight_current_job(const struct in_flight *in_flight)
{
    const struct in_flight_frame *frame = in_flight_current(in_flight);

    return frame ? frame->ticket.job : 0;
}

const struct in_flight_frame *in_flight_furthest(const struct in_flight *in_flight, int64_t job)
{
    const struct in_flight_frame *furthest = NULL;

    for (size_t i = 0; i < in_flight->count; i++) {
        const struct in_flight_frame *frame = &in_flight->frames[i];

        if (frame->ticket.job != job || frame->phase == FRAME_PHASE_NONE) continue;
        if (!furthest || frame->phase > furthest->phase) furthest = frame;
    }
    return furthest;
}

bool in_flight_has_job(const struct in_flight *in_flight, int64_t job)
{
    for (size_t i = 0; i < in_flight->count; i++) {
        if (in_flight->frames[i].ticket.job == job) return true;
    }
    return false;
}
