// The light of a few pixels of pilot frames by all orders of scattering, which plans compare pictures with.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/plan/plan_lattice.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/scatter_progress.h"
#include "worker/render/renderer_fault.h"

#include <stdbool.h>

struct error;
struct truth_pixel;

struct scatter_frame {
    int32_t number;
    struct truth_pixel *truth; // owned; of the lattice's pixels
    double light;              // mean square
};

struct scatter_truth {
    const struct plan_params *params; // borrowed
    struct job job;                   // a shallow copy, with one sample
    struct plan_lattice lattice;
    struct scatter_frame frames[PLAN_PILOT_LIMIT];
    int frame_count;
    double first_share; // RMS of the first order over that of all
    struct scatter_progress progress;
    enum renderer_fault *fault; // borrowed, while it is measured
    struct error *error;        // borrowed, while it is measured
};

// Measures the segment's pilot frames by random paths of reference/, in two halves. On failure `fault` and `error` say
// why; scatter_truth_finish releases it all the same.
bool scatter_truth_measure(struct scatter_truth *light, const struct plan_params *params, enum renderer_fault *fault,
                           struct error *error);
void scatter_truth_finish(struct scatter_truth *light); // accepts a zero value
// The job of the first order alone, by lights without size.
struct job scatter_truth_first_of(const struct job *job);
