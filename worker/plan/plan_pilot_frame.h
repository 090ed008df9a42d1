// One small frame of a pilot: its renders, the light that some of its pixels should show, and how far a render is off.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct audit_pool;
struct error;
struct plan_params;

enum { PLAN_TRUE_PIXELS = 32 }; // of each frame that reference/ measures

struct plan_pilot_frame {
    int32_t number;
    struct image fine, before, seen; // the finest, the one before it, and the last that was measured
    double mean_square;              // of the light
    size_t true_count;
    struct truth_point points[PLAN_TRUE_PIXELS];
    struct truth_pixel truth[PLAN_TRUE_PIXELS];
    double density[PLAN_TRUE_PIXELS]; // of the pixel's draw
};

// On failure, for want of memory, the frame is to be finished all the same.
bool plan_pilot_frame_init(struct plan_pilot_frame *frame, const struct job *job, int32_t number, struct error *error);
void plan_pilot_frame_finish(struct plan_pilot_frame *frame); // accepts the zero value

// What was seen becomes the finest, and what was that the one before it.
void plan_pilot_frame_keep(struct plan_pilot_frame *frame);
// RMS of the difference of the two finest, relative to the finest.
double plan_pilot_frame_change(const struct plan_pilot_frame *frame);
// Has reference/ measure some pixels. `job` is the small one. On failure `fault` is as the renderer's.
bool plan_pilot_frame_measure(struct plan_pilot_frame *frame, const struct plan_params *params, const struct job *job,
                              enum renderer_fault *fault, struct error *error);
// Relative RMSE of what was seen last.
double plan_pilot_frame_error(const struct plan_pilot_frame *frame);
// Adds the measured pixels of what was seen last, its values as encoded.
void plan_pilot_frame_fill(const struct plan_pilot_frame *frame, enum job_pixel pixel, struct audit_pool *pool);
