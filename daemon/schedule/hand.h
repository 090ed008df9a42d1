// The frames a worker holds: given to it, begun, rendered and not yet answered for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/schedule/queue.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct hand_frame {
    struct queue_ticket ticket;
    bool is_started;
    bool is_rendered; // its picture exists and is being encoded
};

// The zero value is empty. In the order they were given.
struct hand {
    struct hand_frame *frames; // owned
    size_t count, capacity;
    size_t rendered_count; // of them
};

void hand_finish(struct hand *hand);
void hand_add(struct hand *hand, const struct queue_ticket *ticket);
// NULL: it does not hold that attempt. The pointer is good until the hand changes.
struct hand_frame *hand_find(const struct hand *hand, int64_t job, int32_t frame, int32_t attempt);
void hand_render(struct hand *hand, struct hand_frame *frame);
void hand_remove(struct hand *hand, struct hand_frame *frame);
// The frame that is being rendered, or else would be next; NULL: none. The pointer is good until the hand changes.
const struct hand_frame *hand_current(const struct hand *hand);
// Its job; 0: none.
int64_t hand_current_job(const struct hand *hand);
bool hand_holds_job(const struct hand *hand, int64_t job);
