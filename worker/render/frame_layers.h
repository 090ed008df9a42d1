// Renders a frame by random paths whose pixels are interpolated as the sum of its two layers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/render/renderer_frame.h"

#include <stdbool.h>

struct error;
struct renderer;

typedef bool frame_layers_render(struct renderer *renderer, const struct renderer_frame *frame,
                                 struct renderer_result *result, struct error *error);

// Has `render` draw the layers (core/job/job_layers.h) and adds the scattered light to what is seen; doubts, counts of
// rays and the share that was traced are of the scattered light. Lists of pixels are the sums of both layers' pixels.
bool frame_layers_add(struct renderer *renderer, frame_layers_render *render, const struct renderer_frame *frame,
                      struct renderer_result *result, struct error *error);
