// SPDX-License-Identifier: Apache-2.0
#include "core/job/frame_order.h"

#include <stdbool.h>

static int64_t stage_length(int32_t stage, int64_t count)
{
    return stage > 0 ? (count + stage - 1) / stage : 1;
}

static int64_t stage_at(int32_t stage, int64_t count, int64_t position)
{
    switch (stage) {
    case FRAME_ORDER_FIRST:
        return 0;
    case FRAME_ORDER_LAST:
        return count - 1;
    case FRAME_ORDER_MIDDLE:
        return count / 2;
    default:
        return position * stage;
    }
}

static bool stage_has(int32_t stage, int64_t count, int64_t index)
{
    return stage > 0 ? index % stage == 0 : index == stage_at(stage, count, 0);
}

int64_t frame_order_length(const struct frame_order *order, int64_t count)
{
    int64_t length = count;

    for (int i = 0; i < order->count; i++)
        length += stage_length(order->stages[i], count);
    return length;
}

int64_t frame_order_at(const struct frame_order *order, int64_t count, int64_t position)
{
    int64_t index;
    int stage = 0;

    for (; stage < order->count && position >= stage_length(order->stages[stage], count); stage++)
        position -= stage_length(order->stages[stage], count);
    index = stage < order->count ? stage_at(order->stages[stage], count, position) : position;
    for (int i = 0; i < stage; i++)
        if (stage_has(order->stages[i], count, index)) return -1;
    return index;
}
