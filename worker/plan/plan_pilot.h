// A few small frames of a segment on which settings are tried: what light they should show, and how far each setting is off.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/plan/plan_family.h"
#include "worker/plan/plan_search.h"
#include "worker/render/renderer.h"

#include <stdbool.h>

struct plan_evidence;
struct error;
struct plan_params;
struct plan_pilot;

// Renders the frames in ever finer steps until two renders agree, and has reference/ measure some of their pixels. Frames
// whose files cannot be read are left out, unless none can. NULL on failure, with `fault` as the renderer's.
struct plan_pilot *plan_pilot_create(const struct plan_params *params, enum renderer_fault *fault, struct error *error);
void plan_pilot_destroy(struct plan_pilot *pilot); // accepts NULL

const struct plan_scene *plan_pilot_scene(const struct plan_pilot *pilot);
// How often the coarsest steps were halved until what is off came near the tolerance.
int plan_pilot_start_level(const struct plan_pilot *pilot);
double plan_pilot_fine_work(const struct plan_pilot *pilot);  // plan_family_work of the finest render
int plan_pilot_count_renders(const struct plan_pilot *pilot); // small ones, so far

struct plan_errors {
    double largest, mean; // relative RMSE of the pilot's frames; the mean is quadratic
    int worst;            // the frame of the largest
};

enum { PLAN_ALL_FRAMES = -1 };

// Renders the frames, or one of them, with `quality`, of a method that renders. Stopped: `fault` and `error` of the pilot say
// why.
enum plan_measured plan_pilot_measure(struct plan_pilot *pilot, const struct job_quality *quality, int frame,
                                      struct plan_errors *errors);
// What was looked up for measurements so far, as work is counted.
double plan_pilot_count_evaluations(const struct plan_pilot *pilot);
// What the last measurement was stopped by.
enum renderer_fault plan_pilot_fault(const struct plan_pilot *pilot, struct error *error);

// Gives up what was rendered and measured of the quality that plan_pilot_measure saw last; nothing is measured after that.
void plan_pilot_give(struct plan_pilot *pilot, struct plan_evidence *evidence);
