// Renders frames that are sums of layers (core/job/job_layers.h).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/render/renderer_frame.h"

#include <stdbool.h>

struct error;
struct renderer;

struct frame_layers {
    const struct renderer_frame *frame; // borrowed
    // Draws one layer, whose job and image are in `frame`.
    bool (*render)(struct renderer *renderer, const struct renderer_frame *frame, struct renderer_result *result,
                   struct error *error);
};

// Has the layers of a frame drawn and adds them up; a frame that has none is drawn as it is. Doubts, counts of rays and
// the share that was traced are those of the layer that takes the time: scattered light, or media without the dome
// behind them. Lists of pixels are the sums of their layers' pixels.
bool frame_layers_render(struct renderer *renderer, const struct frame_layers *layers, struct renderer_result *result,
                         struct error *error);
