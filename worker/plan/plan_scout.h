// How far off a plan is in frames that it was not made from: many of its segment's frames, tiny and in two steps.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/render/renderer.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct job;
struct plan;
struct plan_params;
struct plan_scene;

enum { PLAN_SCOUT_LIMIT = 17 }; // odd, so that the pilot's middle frame is among them

struct plan_scouting {
    int count;           // 0: nothing is known but of the pilot's frames
    int64_t first, last; // the first and the last frame, by index in the job's range; the others lie evenly between
    double error[PLAN_SCOUT_LIMIT]; // relative RMSE that is expected of the plan as it is
};

// Fills the plan's scouting; its predicted_error is that of the pilot's frames, by which what finer steps change is scaled, and
// becomes that of all, refined as plan_scout_find_rungs says. `rays` are the pilot's. Without effect where it would tell nothing,
// of a scene that stays, or cost too much: where each frame reads files of its own, or next to the frames themselves. On failure
// `fault` is as the renderer's.
bool plan_scout_look(struct plan *plan, const struct plan_params *params, const struct plan_scene *rays,
                     enum renderer_fault *fault, struct error *error);
// How many rungs finer than the plan a frame is rendered to begin with, by index in the job's range; 0: as planned. Pure.
int plan_scout_find_rungs(const struct plan_scouting *scouting, int64_t index, double tolerance);
