// A pilot: some pixels of a few frames of a segment, on which settings are tried, and the error of each setting.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/plan/plan_family.h"
#include "worker/plan/plan_search.h"
#include "worker/plan/plan_segment.h"
#include "worker/render/renderer_fault.h"

#include <stdbool.h>

struct plan_evidence;
struct plan_family;
struct error;
struct plan_params;
struct plan_pilot;

// Renders the frames in ever finer steps until two renders agree, and has reference/ measure some of their pixels.
// Frames whose files cannot be read are left out, unless that is all of them. `params` outlives the pilot. NULL on
// failure, `fault` then being one of the renderer's.
struct plan_pilot *plan_pilot_create(const struct plan_params *params, enum renderer_fault *fault, struct error *error);
void plan_pilot_destroy(struct plan_pilot *pilot); // accepts NULL

const struct plan_scene *plan_pilot_scene(const struct plan_pilot *pilot);
// How often the coarsest steps were halved before halving them again changed less than the tolerance.
int plan_pilot_start_level(const struct plan_pilot *pilot);
double plan_pilot_fine_work(const struct plan_pilot *pilot);  // plan_family_work of the finest render
int plan_pilot_count_renders(const struct plan_pilot *pilot); // number of renders so far

struct plan_errors {
    double largest, mean; // relative RMSE over the measured frames; the mean is quadratic
    int worst;            // index of the frame with the largest
    int count;            // of measured frames
    double each[PLAN_PILOT_LIMIT];
};

enum { PLAN_ALL_FRAMES = -1 };

// Renders all frames, or the one of index `frame`, with `quality`, whose method is never auto. After PLAN_STOPPED
// plan_pilot_fault says why.
enum plan_measured plan_pilot_measure(struct plan_pilot *pilot, const struct job_quality *quality, int frame,
                                      struct plan_errors *errors);
// The family that is rendered in ever finer steps.
const struct plan_family *plan_pilot_finest(const struct plan_pilot *pilot);
// Evaluations of density in all measurements so far, as plan_family_work counts them.
double plan_pilot_count_evaluations(const struct plan_pilot *pilot);
// The fault and the error that stopped the last measurement.
enum renderer_fault plan_pilot_fault(const struct plan_pilot *pilot, struct error *error);

// Moves the renders and samples of the quality measured last to `evidence`. Afterwards nothing can be measured.
void plan_pilot_give(struct plan_pilot *pilot, struct plan_evidence *evidence);
