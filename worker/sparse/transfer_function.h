// A transfer function: its greatest opacity in a range, and its text in GLSL.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

// Returns the greatest opacity of values in [min, max].
double transfer_function_max_opacity(const struct scene_transfer_point *points, size_t count, double min, double max);

// Returns true when no value in [min, max] has any opacity; without points, when none is above 0.
bool transfer_function_is_empty(const struct scene_transfer_point *points, size_t count, double min, double max);

// Writes `float PREFIX_opacity(float value)` and `vec3 PREFIX_rgb(float value)`, by transfer/piecewise.glsl.
void transfer_function_write(FILE *out, const char *prefix, const struct scene_transfer_point *points, size_t count);
