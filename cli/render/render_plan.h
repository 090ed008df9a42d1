// Which frames a single worker has in hand, which wait, and which are given up.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct frame_range;

enum {
    RENDER_PLAN_AHEAD = 3,   // one is encoded, one rendered, one waits so that the GPU does not
    RENDER_PLAN_ATTEMPTS = 3 // lost that often, a frame is given up
};

struct render_ticket {
    int32_t frame;
    int attempt; // from 1
    bool is_started;
    bool is_rendered; // its picture exists and is being encoded
};

// Set `frames` and leave the rest zero.
struct render_plan {
    const struct frame_range *frames; // borrowed; outlives us
    int64_t next;                     // index in `frames`
    struct render_ticket in_hand[RENDER_PLAN_AHEAD];
    size_t in_hand_count;
    struct render_ticket lost[RENDER_PLAN_AHEAD]; // to be tried again before all others, one by one
    size_t lost_count;
};

// The next frame for the worker; false when it has enough or none is left.
bool render_plan_take(struct render_plan *plan, struct render_ticket *ticket);
void render_plan_start(struct render_plan *plan, int32_t frame);
void render_plan_render(struct render_plan *plan, int32_t frame);
// False when that attempt is not in hand: a message nobody waits for.
bool render_plan_end(struct render_plan *plan, int32_t frame, int attempt);
// The worker is gone. What it had started counts as tried; frames tried too often are written to `given_up`, and so is the
// one it rendered where that `is_endless`; the rest waits. Returns how many are given up.
size_t render_plan_lose(struct render_plan *plan, bool is_endless,
                        struct render_ticket given_up[static RENDER_PLAN_AHEAD]);
bool render_plan_is_done(const struct render_plan *plan);
