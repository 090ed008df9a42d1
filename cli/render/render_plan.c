// SPDX-License-Identifier: Apache-2.0
#include "cli/render/render_plan.h"

#include "core/job/frame_range.h"

#include <string.h>

// The index of the frame at or after the position `next`, which moves there; -1: there are no more.
static int64_t find_next(struct render_plan *plan)
{
    int64_t count = frame_range_count(plan->frames), length = frame_order_length(&plan->order, count), index = -1;

    while (plan->next < length && (index = frame_order_at(&plan->order, count, plan->next)) < 0)
        plan->next++;
    return index;
}

bool render_plan_take(struct render_plan *plan, struct render_ticket *ticket)
{
    if (plan->lost_count > 0) {
        // Retried alone, so that the next failure is certainly its own.
        if (plan->in_flight_count > 0) return false;
        *ticket = plan->lost[0];
        memmove(plan->lost, plan->lost + 1, --plan->lost_count * sizeof *plan->lost);
    } else {
        int64_t index = find_next(plan);

        if (plan->in_flight_count == RENDER_PLAN_AHEAD || index < 0) return false;
        plan->next++;
        *ticket = (struct render_ticket){.frame = frame_range_at(plan->frames, index), .attempt = 1};
    }
    plan->in_flight[plan->in_flight_count++] = *ticket;
    return true;
}

void render_plan_start(struct render_plan *plan, int32_t frame)
{
    for (size_t i = 0; i < plan->in_flight_count; i++)
        if (plan->in_flight[i].frame == frame) plan->in_flight[i].is_started = true;
}

void render_plan_render(struct render_plan *plan, int32_t frame)
{
    for (size_t i = 0; i < plan->in_flight_count; i++)
        if (plan->in_flight[i].frame == frame) plan->in_flight[i].is_rendered = true;
}

bool render_plan_end(struct render_plan *plan, int32_t frame, int attempt)
{
    for (size_t i = 0; i < plan->in_flight_count; i++) {
        if (plan->in_flight[i].frame != frame || plan->in_flight[i].attempt != attempt) continue;
        memmove(plan->in_flight + i, plan->in_flight + i + 1, (--plan->in_flight_count - i) * sizeof *plan->in_flight);
        return true;
    }
    return false;
}

size_t render_plan_lose(struct render_plan *plan, bool is_endless,
                        struct render_ticket given_up[static RENDER_PLAN_AHEAD])
{
    struct render_ticket waiting[RENDER_PLAN_AHEAD];
    size_t given_up_count = 0, waiting_count = 0;

    for (size_t i = 0; i < plan->in_flight_count; i++) {
        struct render_ticket ticket = plan->in_flight[i];

        if (ticket.is_started && (ticket.attempt == RENDER_PLAN_ATTEMPTS || (is_endless && !ticket.is_rendered))) {
            given_up[given_up_count++] = ticket;
            continue;
        }
        if (ticket.is_started) ticket.attempt++;
        ticket.is_started = ticket.is_rendered = false;
        waiting[waiting_count++] = ticket;
    }
    // While lost frames wait, at most one frame is in flight: both together fit.
    for (size_t i = 0; i < plan->lost_count && waiting_count < RENDER_PLAN_AHEAD; i++)
        waiting[waiting_count++] = plan->lost[i];
    memcpy(plan->lost, waiting, waiting_count * sizeof *waiting);
    plan->lost_count = waiting_count;
    plan->in_flight_count = 0;
    return given_up_count;
}

bool render_plan_is_done(const struct render_plan *plan)
{
    struct render_plan rest = *plan;

    return plan->in_flight_count == 0 && plan->lost_count == 0 && find_next(&rest) < 0;
}
