// What a segment's modelled orders of scattering leave out, measured for a small part of the segment's work.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job_beyond.h"
#include "worker/plan/plan_params.h"
#include "worker/render/renderer_fault.h"

#include <stdbool.h>

struct error;
struct plan;

// Random numbers that paths may draw beside counted work, of which linking programs is a part: 2 % of it, and at most
// as many as take as long as one link.
double plan_beyond_find_limit(double work);

// Sets the plan's `beyond`, in the segment's pilot frames. The plan is whole but for predicted seconds; where
// those are wanted, somebody asks and nothing is rendered by the plan: no work limits it. On failure `fault` is one of
// the renderer's: it was stopped.
bool plan_beyond_measure(struct plan *plan, const struct plan_params *params, enum renderer_fault *fault,
                         struct error *error);
// Of a job that states its method, or a draft: in the first segment's pilot frames, beside the work of one frame, since
// every worker that renders some of its frames measures it for itself. False when it was stopped. `params` need no
// segment.
bool plan_beyond_measure_stated(const struct plan_params *params, struct job_beyond *beyond);
// The same for whoever asks before anything is rendered: as exactly as the longest job has it.
bool plan_beyond_measure_asked(const struct plan_params *params, struct job_beyond *beyond);
