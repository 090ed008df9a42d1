// The frames of a local job: which the worker has, which wait, which are given up.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/frame_order.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct frame_range;

enum {
    RENDER_PLAN_AHEAD = 3,   // frames in flight: one is encoded, one rendered, one waits to keep the GPU busy
    RENDER_PLAN_ATTEMPTS = 3 // a frame is given up after so many lost attempts
};

struct render_ticket {
    int32_t frame;
    int attempt; // from 1
    bool is_started;
    bool is_rendered; // the picture is being encoded
};

// Set `frames`, and `order` if there is one, and leave the rest zero.
struct render_plan {
    const struct frame_range *frames; // borrowed; outlives us
    struct frame_order order;
    int64_t next; // position in the order
    struct render_ticket in_flight[RENDER_PLAN_AHEAD];
    size_t in_flight_count;
    struct render_ticket lost[RENDER_PLAN_AHEAD]; // to be retried before all others, one at a time
    size_t lost_count;
};

// The next frame for the worker; false when it has enough or none is left.
bool render_plan_take(struct render_plan *plan, struct render_ticket *ticket);
void render_plan_start(struct render_plan *plan, int32_t frame);
void render_plan_render(struct render_plan *plan, int32_t frame);
// False when that attempt is not in flight: the message is outdated.
bool render_plan_end(struct render_plan *plan, int32_t frame, int attempt);
// Call when the worker is gone. Frames that it had started count as tried. Frames tried too often are written to
// `given_up`, and so is the one it rendered if `is_endless`; the others wait. Returns the number of those given up.
size_t render_plan_lose(struct render_plan *plan, bool is_endless,
                        struct render_ticket given_up[static RENDER_PLAN_AHEAD]);
bool render_plan_is_done(const struct render_plan *plan);
