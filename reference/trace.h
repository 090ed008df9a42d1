// Follows a camera ray through a still: the light of media along it, and the rays that surfaces reflect and refract.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/integrate.h"
#include "reference/still.h"

#include <stdbool.h>
#include <stdint.h>

struct trace_result {
    double radiance[3];
    double transmittance[3]; // of light from behind everything, without reflections
    double ray_count;        // the camera's own included
    // The cut rays; the sum of their throughputs, each the mean of the three colours; the part of that sum that was cut
    // by depth.
    double cut_count, cut_throughput, cut_by_depth;
    bool is_converged;
};

// `seed` starts the random numbers of rough surfaces. `accuracy` may be NULL.
struct trace_result trace_ray(const struct still *still, const struct ray *ray, uint64_t seed,
                              const struct integrate_accuracy *accuracy);
