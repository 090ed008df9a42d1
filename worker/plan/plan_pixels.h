// Which pixels of a plan's frames are traced.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/render/renderer_fault.h"

#include <stdbool.h>

struct error;
struct plan;
struct plan_params;

// Sets `pixels` of a plan whose other settings and predicted error are known, and what it predicts of them. The
// middle frame of the segment is rendered so once or twice, and what it lacks is measured. The threshold follows from
// that: interpolation may add what the settings leave of the error that plans aim at, but at least 0.3 and at most half
// of the tolerance. Where the plan has random paths of pixels, one frame with fewer of them tells how many pixels are
// traced, and their noise: the number of paths then follows from it. All pixels are traced where that is no gain (with
// a GPU also where it draws the frame in less time than interpolation takes), and where they have random numbers of
// their own whose noise isn't known. False when it was stopped or GL was lost.
bool plan_pixels_choose(struct plan *plan, const struct plan_params *params, enum renderer_fault *fault,
                        struct error *error);
// Asks for less doubt in a frame that was over its tolerance by its interpolated pixels. Where that would trace most of
// the pixels, all are.
void plan_pixels_refine(struct plan *plan, double interpolation_error, double tolerance);
// The same of a frame by random paths that was off by `error`. False where its noise explains that: then more paths are
// missing.
bool plan_pixels_refine_paths(struct plan *plan, double noise, double error);
