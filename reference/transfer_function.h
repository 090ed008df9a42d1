// Colour and extinction by a value: straight linear RGBA between points, opacity over a unit of distance.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

struct transfer_function {
    const struct scene_transfer_point *points; // borrowed; ascending values, at least one
    size_t count;
    double unit_distance; // m
};

double transfer_function_extinction(const struct transfer_function *transfer, double value); // per metre
void transfer_function_color(const struct transfer_function *transfer, double value, double rgb[static 3]);
// The greatest extinction of the values from `low` to `high`.
double transfer_function_most(const struct transfer_function *transfer, double low, double high);
// True when no value from `low` to `high` has any opacity.
bool transfer_function_is_clear(const struct transfer_function *transfer, double low, double high);
