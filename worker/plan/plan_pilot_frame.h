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

// Points that reference/ measures, of a pilot's only frame, and of each of several.
enum { PLAN_TRUE_PIXELS = 64, PLAN_TRUE_PIXELS_EACH = 32 };

struct plan_pilot_frame {
    int32_t number;
    struct image fine, before, seen;       // of the lattice: the finest render, the one before it, and the latest
    double mean_square;                    // of the values of `fine`
    size_t point_count, true_count;        // drawn, and measured
    struct pixel points[PLAN_TRUE_PIXELS]; // in those images
    double density[PLAN_TRUE_PIXELS];      // probability density with which each was drawn
    struct truth_pixel truth[PLAN_TRUE_PIXELS];
};

void plan_pilot_frame_finish(struct plan_pilot_frame *frame); // accepts the zero value

// Makes `seen` the finest render, and the finest one `before`.
void plan_pilot_frame_keep(struct plan_pilot_frame *frame);
// RMS of the difference between `fine` and `before`, relative to the RMS of `fine`.
double plan_pilot_frame_change(const struct plan_pilot_frame *frame);
// Draws points, as audits draw theirs; `count` is at most PLAN_TRUE_PIXELS.
void plan_pilot_frame_draw(struct plan_pilot_frame *frame, const struct job *job, size_t count);
// Has reference/ measure the points. `job` has one sample. On failure `fault` is one of the renderer's.
bool plan_pilot_frame_measure(struct plan_pilot_frame *frame, const struct plan_params *params,
                              const struct plan_lattice *lattice, const struct job *job, enum renderer_fault *fault,
                              struct error *error);
// Relative RMSE of `seen`.
double plan_pilot_frame_error(const struct plan_pilot_frame *frame);
// Adds samples of `seen`, with its values as encoded, at the measured pixels.
void plan_pilot_frame_fill(const struct plan_pilot_frame *frame, enum job_pixel pixel, struct audit_pool *pool);
