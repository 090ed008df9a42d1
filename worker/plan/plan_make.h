// Makes the plan of a segment: tries methods and their numbers on small frames, and predicts what the frames take.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/render/renderer.h"

#include <stdbool.h>

struct error;
struct plan;
struct plan_params;

// Chooses from errors and counted work, so that every worker chooses the same. On failure `fault` is as the renderer's.
bool plan_make(struct plan *plan, const struct plan_params *params, enum renderer_fault *fault, struct error *error);
