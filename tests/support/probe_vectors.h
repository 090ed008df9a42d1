// Vectors among the inputs and outputs of a shader probe.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/vec3.h"
#include "tests/support/random.h"

#include <math.h>

static inline struct vec3 probe_vector(const float value[4])
{
    return (struct vec3){value[0], value[1], value[2]};
}

// The fourth component stays unchanged.
static inline void probe_put_vector(float value[4], struct vec3 vector)
{
    value[0] = (float)vector.x;
    value[1] = (float)vector.y;
    value[2] = (float)vector.z;
}

// A random unit vector, uniform over the sphere.
static inline struct vec3 probe_any_direction(struct random *random)
{
    double z = random_between(random, -1, 1), angle = random_between(random, 0, 2 * M_PI);

    return (struct vec3){sqrt(1 - z * z) * cos(angle), sqrt(1 - z * z) * sin(angle), z};
}
