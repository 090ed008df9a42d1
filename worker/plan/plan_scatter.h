// Plans of scenes that scatter light more than once: the first order is planned alone, then random paths for the rest.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_params.h"
#include "worker/render/renderer_fault.h"

#include <stdbool.h>

struct error;
struct plan_scatter;

// Measures all of the light in some pixels of the segment's pilot frames. `params` outlives it; its job has more orders
// than one. NULL on failure.
struct plan_scatter *plan_scatter_create(const struct plan_params *params, enum renderer_fault *fault,
                                         struct error *error);
void plan_scatter_destroy(struct plan_scatter *scatter); // accepts NULL

// The job whose plan is made first: one order of scattering, of the lights that a march shows. Its tolerance is the
// part of the whole error that it may have, relative to its own light. Never finished.
struct job plan_scatter_first_job(const struct plan_scatter *scatter);
// Turns that job's plan into one of all orders. On failure `fault` is one of the renderer's.
bool plan_scatter_complete(struct plan_scatter *scatter, struct plan *plan, enum renderer_fault *fault,
                           struct error *error);
// Writes the reason of a plan that has paths of pixels, again where their number or the pixels have changed.
void plan_scatter_describe_paths(struct plan *plan);
