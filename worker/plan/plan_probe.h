// Probes of a rendered frame: some of its own pixels in other settings. They tell what is to blame for its error.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/plan/plan_search.h"
#include "worker/render/renderer_fault.h"

#include <stdbool.h>
#include <stdint.h>

struct audit_result;
struct error;
struct image;
struct job;
struct plan;
struct plan_lattice;
struct plan_params;
struct plan_retry;
struct plan_view;
struct renderer_result;

// All is borrowed.
struct plan_probe {
    const struct plan_params *params; // renderer, job and progress
    int32_t frame;
    const struct plan *plan;   // by which the frame was rendered
    const struct image *image; // the frame, of the job's size
};

// The pixels that are probed, with all samples of the frame: together about a ninth of the frame's rays. Of each block
// it is the brightest, because a frame's error is mostly where its light is, and that may be in few pixels.
void plan_probe_init_lattice(struct plan_lattice *lattice, const struct job *job, const struct image *frame);
// Finds the RMS of the frame's change when an axis of the plan moves as plan_retry_vary moves it; 0 where such a
// setting cannot be rendered. The retry pays. False when it was stopped or GL was lost.
bool plan_probe_axes(const struct plan_probe *probe, struct plan_retry *retry, double changes[static PLAN_AXIS_LIMIT],
                     enum renderer_fault *fault, struct error *error);
// Above order 1, where the plan knows what cells and paths add and plan_retry_know has written it: writes the errors of
// the march, in the same unit, which pictures with little scattered light tell. For the rest as above.
bool plan_probe_march(const struct plan_probe *probe, struct plan_retry *retry, double changes[static PLAN_AXIS_LIMIT],
                      enum renderer_fault *fault, struct error *error);

// The pixels of an audit by step halving: about as many rays as one for each pixel of the view.
void plan_probe_init_audit(struct plan_lattice *lattice, const struct job *job, const struct plan_view *view);
// Renders a list of the frame's pixels in half the plan's steps, and lets it stand for the truth: paths are followed
// further, and the user's code is evaluated even where its lipschitz promises empty space. Light that is not finite is
// told as finite_check_tell does, with RENDERER_FAULT_FRAME.
bool plan_probe_render_truth(const struct plan_params *params, const struct plan *plan, int32_t frame,
                             const struct plan_lattice *lattice, struct image *image, struct renderer_result *result,
                             struct error *error);
// Compares such pixels with the frame's.
bool plan_probe_audit(const struct plan_probe *probe, const struct plan_view *view, struct audit_result *audit,
                      enum renderer_fault *fault, struct error *error);
