// How far off a plan is in frames that it was not made from: many of its segment's frames, tiny and in two steps.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/render/renderer.h"

#include <stdbool.h>

struct error;
struct plan;
struct plan_params;
struct plan_scene;

// Fills the plan's scouting; its predicted_error is that of the pilot's frames, by which what finer steps change is scaled, and
// becomes that of all, refined as plan_scouting_find_rungs says. `rays` are the pilot's. Without effect where it would tell nothing,
// of a scene that stays, or cost too much: where each frame reads files of its own, or next to the frames themselves. On failure
// `fault` is as the renderer's.
bool plan_scout_measure(struct plan *plan, const struct plan_params *params, const struct plan_scene *rays,
                        enum renderer_fault *fault, struct error *error);
