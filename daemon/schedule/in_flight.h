// The frames in flight of one worker: assigned to it, and not finished, skipped, failed or dropped.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/frame_phase.h"
#include "daemon/schedule/queue.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct in_flight_frame {
    struct queue_ticket ticket;
    bool is_started;
    bool is_recalled; // its worker is told to give it back
    bool is_rendered; // it is rendered and being encoded
    enum frame_phase phase;
    double phase_progress; // 0 to 1; negative: unknown
    int plan_messages;     // count of its worker's questions and plans
};

// Frames in the order of their assignment. The zero value is empty.
struct in_flight {
    struct in_flight_frame *frames; // owned
    size_t count, capacity;
    size_t rendered_count; // count of frames with is_rendered
};

void in_flight_finish(struct in_flight *in_flight);
void in_flight_add(struct in_flight *in_flight, const struct queue_ticket *ticket);
// NULL: that attempt is not in flight. The pointer is valid until a frame is added or removed.
struct in_flight_frame *in_flight_find(const struct in_flight *in_flight, int64_t job, int32_t frame, int32_t attempt);
void in_flight_mark_rendered(struct in_flight *in_flight, struct in_flight_frame *frame);
void in_flight_remove(struct in_flight *in_flight, struct in_flight_frame *frame);
// The frame that is being rendered or is next, else the first being encoded; NULL: none. Valid as above.
const struct in_flight_frame *in_flight_current(const struct in_flight *in_flight);
// The job of that frame; 0: none.
int64_t in_flight_current_job(const struct in_flight *in_flight);
// The frame of the job whose phase is the furthest; NULL: none is worked on. Valid as above.
const struct in_flight_frame *in_flight_furthest(const struct in_flight *in_flight, int64_t job);
bool in_flight_has_job(const struct in_flight *in_flight, int64_t job);
