// Measures a plan's error in frames that it was not made from: small lattices of many, in two steps.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/render/renderer_fault.h"

#include <stdbool.h>

struct error;
struct plan;
struct plan_params;
struct plan_scene;

// Fills the plan's scouting and replaces its predicted_error. Before the call that is the pilot frames' error, by which
// the measured changes are scaled; afterwards it is the error of all frames of the segment, refined as
// plan_scouting_find_rungs says. `rays` is the pilot's scene. The pilot's frames stay the only scouts of constant
// scenes, of jobs of which each frame reads files of its own, and where more would cost too much. On failure `fault` is
// one of the renderer's.
bool plan_scout_measure(struct plan *plan, const struct plan_params *params, const struct plan_scene *rays,
                        enum renderer_fault *fault, struct error *error);

// Makes the whole plan finer in what is to blame for the error of the worst frame, where that takes less work than the
// frames that plan_of_frame refines in everything. `is_finer` says so; then the plan has no scouting, and what is
// measured of it no longer holds. `plan` has its work_ratio. On failure `fault` is one of the renderer's.
bool plan_scout_settle(struct plan *plan, const struct plan_params *params, const struct plan_scene *rays,
                       bool *is_finer, enum renderer_fault *fault, struct error *error);
