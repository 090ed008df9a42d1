// The frames a worker holds: given to it, begun, rendered and not yet answered for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/schedule/queue.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct in_flight_frame {
    struct queue_ticket ticket;
    bool is_started;
    bool is_rendered; // its picture exists and is being encoded
};

// The zero value is empty. In the order they were given.
struct in_flight {
    struct in_flight_frame *frames; // owned
    size_t count, capacity;
    size_t rendered_count; // of them
};

void in_flight_finish(struct in_flight *in_flight);
void in_flight_add(struct in_flight *in_flight, const struct queue_ticket *ticket);
// NULL: it does not hold that attempt. The pointer is good until the hand changes.
struct in_flight_frame *in_flight_find(const struct in_flight *in_flight, int64_t job, int32_t frame, int32_t attempt);
void in_flight_mark_rendered(struct in_flight *in_flight, struct in_flight_frame *frame);
void in_flight_remove(struct in_flight *in_flight, struct in_flight_frame *frame);
// The frame that is being rendered, or else would be next; NULL: none. The pointer is good until the hand changes.
const struct in_flight_frame *in_flight_current(const struct in_flight *in_flight);
// Its job; 0: none.
int64_t in_flight_current_job(const struct in_flight *in_flight);
bool in_flight_has_job(const struct in_flight *in_flight, int64_t job);
