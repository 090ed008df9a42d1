// One frame of a pilot: renders of its lattice, the reference's light in some of its pixels, and the error of a render.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/render/renderer_fault.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct audit_pool;
struct error;
struct plan_lattice;
struct plan_params;

enum { PLAN_TRUE_PIXELS = 32 }; // pixels of each frame that reference/ measures

struct plan_pilot_frame {
    int32_t number;
    struct image fine, before, seen; // of the lattice: the finest render, the one before it, and the latest
    double mean_square;              // of the values of `fine`
    size_t true_count;
    struct pixel points[PLAN_TRUE_PIXELS]; // in those images
    struct truth_pixel truth[PLAN_TRUE_PIXELS];
    double density[PLAN_TRUE_PIXELS]; // probability density with which each was drawn
};

void plan_pilot_frame_finish(struct plan_pilot_frame *frame); // accepts the zero value

// Makes `seen` the finest render, and the finest one `before`.
void plan_pilot_frame_keep(struct plan_pilot_frame *frame);
// RMS of the difference between `fine` and `before`, relative to the RMS of `fine`.
double plan_pilot_frame_change(const struct plan_pilot_frame *frame);
// Has reference/ measure some pixels of the lattice. `job` has one sample. On failure `fault` is one of the renderer's.
bool plan_pilot_frame_measure(struct plan_pilot_frame *frame, const struct plan_params *params,
                              const struct plan_lattice *lattice, const struct job *job, enum renderer_fault *fault,
                              struct error *error);
// Relative RMSE of `seen`.
double plan_pilot_frame_error(const struct plan_pilot_frame *frame);
// Adds samples of `seen`, with its values as encoded, at the measured pixels.
void plan_pilot_frame_fill(const struct plan_pilot_frame *frame, enum job_pixel pixel, struct audit_pool *pool);
