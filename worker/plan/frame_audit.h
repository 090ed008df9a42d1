// The audit of a planned frame: what its settings cost in accuracy, and what interpolated pixels add.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/render/renderer_fault.h"

#include <stdbool.h>
#include <stdint.h>

struct audit_result;
struct error;
struct image;
struct plan;
struct plan_kept;
struct plan_params;

// All is borrowed.
struct frame_audit {
    const struct plan_params *params; // renderer, job and progress
    int32_t frame;
    const struct image *image;
    struct plan_kept *kept;  // of the frame's segment; keeps the reference open
    const struct plan *plan; // that rendered the frame
    bool is_finer;           // or otherwise not what the plan's samples were measured in: none are shared
    bool is_replaceable;     // as audit.h has it
};

// Compares some of the frame's pixels, traced, with reference/ or, where code of the user's has no twin, with finer
// steps. Of a frame that has interpolated pixels, some are traced for comparison, too (pixel_audit.h): both errors add
// up by their squares, and both bounds by the triangle inequality. A frame by random paths, whose noise would look like
// interpolation, is compared as it is. False when it was stopped, or with the fault of what
// could not be rendered or read.
bool frame_audit_run(const struct frame_audit *audit, struct audit_result *result, enum renderer_fault *fault,
                     struct error *error);
