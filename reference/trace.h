// Follows a camera ray through a still: what it gathers in media, and the rays that surfaces send on from it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/integrate.h"
#include "reference/still.h"

#include <stdbool.h>
#include <stdint.h>

struct trace_result {
    double radiance[3];
    double transmittance[3]; // of light from behind everything that comes without a reflection
    double ray_count;        // the camera's own among them
    // Rays that were not followed, the sum of their throughputs, each the mean of the three colours, and how much of that
    // their depth alone cut.
    double cut_count, cut_throughput, cut_by_depth;
    bool is_converged;
};

// `seed` is where rough surfaces' random numbers start. `accuracy` may be NULL.
struct trace_result trace_ray(const struct still *still, const struct ray *ray, uint64_t seed,
                              const struct integrate_accuracy *accuracy);
