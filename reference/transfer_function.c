// SPDX-License-Identifier: Apache-2.0
#include "reference/transfer_function.h"

#include <math.h>

static double component(const struct transfer_function *transfer, double value, int c)
{
    const struct scene_transfer_point *points = transfer->points;
    size_t after = 0;
    double share;

    while (after < transfer->count && points[after].value <= value)
        after++;
    if (after == 0) return points[0].rgba[c];
    if (after == transfer->count) return points[after - 1].rgba[c];
    share = (value - points[after - 1].value) / (points[after].value - points[after - 1].value);
    return points[after - 1].rgba[c] + share * (points[after].rgba[c] - points[after - 1].rgba[c]);
}

double transfer_function_extinction(const struct transfer_function *transfer, double value)
{
    return -log1p(-component(transfer, value, 3)) / transfer->unit_distance;
}

void transfer_function_color(const struct transfer_function *transfer, double value, double rgb[static 3])
{
    for (int c = 0; c < 3; c++)
        rgb[c] = component(transfer, value, c);
}

double transfer_function_most(const struct transfer_function *transfer, double low, double high)
{
    double most = fmax(component(transfer, low, 3), component(transfer, high, 3));

    for (size_t i = 0; i < transfer->count; i++) {
        const struct scene_transfer_point *point = &transfer->points[i];

        if (low <= point->value && point->value <= high) most = fmax(most, point->rgba[3]);
    }
    return -log1p(-most) / transfer->unit_distance;
}

bool transfer_function_is_clear(const struct transfer_function *transfer, double low, double high)
{
    if (component(transfer, low, 3) > 0.0 || component(transfer, high, 3) > 0.0) return false;
    for (size_t i = 0; i < transfer->count; i++) {
        const struct scene_transfer_point *point = &transfer->points[i];

        if (low <= point->value && point->value <= high && point->rgba[3] > 0.0) return false;
    }
    return true;
}
