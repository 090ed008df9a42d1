// Small renders of a job's frames, by which plans are tried and timed, and the progress that they report.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/render/renderer.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct image;
struct plan_params;

// The factor by which a frame's sides shrink so that it has at most `pixel_limit` pixels; at most 1.
double plan_small_scale(const struct job *job, int pixel_limit);
// A shallow copy of the job, its sides scaled; never finished.
struct job plan_small_job(const struct job *job, double scale);

// Renders a frame of such a job. Allocates the image anew if its size or channels differ. On failure `result` has the
// fault.
bool plan_small_render(const struct plan_params *params, const struct job *job, int32_t frame, struct image *image,
                       struct renderer_result *result, struct error *error);

// Callbacks for renders and audits; `user` is the const struct plan_params. False: stop.
bool plan_small_on_tile(void *user, double done);
bool plan_small_on_pixel(void *user);
