// What is said of a frame that missed its tolerance: the least error, by which settings, at what cost, and what helps.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/plan/plan.h"

#include <stdbool.h>

struct audit_result;
struct error;
struct job;
struct job_quality;
struct scene_density;

struct miss {
    const struct job *job;             // borrowed, as are the next two
    const struct job_quality *quality; // of the rendering with the least error
    const struct audit_result *audit;  // of that rendering
    double first_error;                // of the first rendering; infinite: GL cut it
    int rendering_count;
    double work; // of all renderings, relative to the first
};

// True for code of the user's with a `lipschitz`, a promise on which the shader relies.
bool miss_has_promise(const struct scene_density *density);
// The reason of `plan`, by which a frame is rendered again: `before` had this error, infinite where GL cut it.
void miss_describe_retry(const struct plan *before, double error, const struct plan *plan,
                         char reason[static PLAN_REASON_SIZE]);
void miss_describe(const struct miss *miss, struct error *error);
