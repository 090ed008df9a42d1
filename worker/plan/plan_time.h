// Predicts how long a frame of a plan takes, from frames that are rendered in two sizes.
// SPDX-License-Identifier: Apache-2.0
// These are small frames, not lists of pixels: they are drawn in rows, and copied where nothing changes, as the job's
// frames are. A list is never a copy, and its pixels cost up to a third more where rays end early. Frames with
// interpolated pixels are timed at their own size: traced pixels are those in which most is to be seen, and cost
// several times as much as others. Where that would take long, what the pace of the plan's own paths foretells is
// believed.
#pragma once

#include "worker/render/renderer_fault.h"

#include <stdbool.h>

struct error;
struct plan;
struct plan_params;

// Sets predicted_s, which has what paths foretell or is 0, and, in software, predicted_processor_s. On failure `fault`
// is one of the renderer's.
bool plan_time_predict(struct plan *plan, const struct plan_params *params, enum renderer_fault *fault,
                       struct error *error);
