// Makes the plan of a segment: tries methods and numbers on some of its pixels, and predicts what its frames take.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/render/renderer_fault.h"

#include <stdbool.h>

struct error;
struct plan;
struct plan_params;

// Chooses by errors and counted work alone, so that every worker chooses the same plan. On failure `fault` is one of
// the renderer's.
bool plan_make(struct plan *plan, const struct plan_params *params, enum renderer_fault *fault, struct error *error);
