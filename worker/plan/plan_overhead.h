// Predicts the overhead of a frame beside its rendering: its audit and its file, measured on one small frame.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/render/renderer_fault.h"

#include <stdbool.h>

struct error;
struct plan;
struct plan_evidence;
struct plan_params;

// Sets predicted_audit_s, predicted_encode_s and predicted_frame_s of a plan whose predicted_s is known. On failure
// `fault` is one of the renderer's.
bool plan_overhead_predict(struct plan *plan, const struct plan_params *params, const struct plan_evidence *evidence,
                           enum renderer_fault *fault, struct error *error);
