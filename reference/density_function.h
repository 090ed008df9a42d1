// A density given by a C function: the twin of one written in GLSL.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/density.h"

// The value that GLSL's `float density(vec3 p, float t)` returns.
typedef double density_function_at(const void *context, struct vec3 position, double time);

// density = scale max(at(position, time), 0)
struct density_function {
    density_function_at *at;
    const void *context; // borrowed; outlives us
    double time, scale;
    double majorant; // no value is above it; 0: none is known
};

struct density density_function(const struct density_function *field); // borrows the field
