// Visibility of media: a frame leaves out those that neither camera rays nor shadow rays to visible media meet.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"

#include <stdbool.h>
#include <stdint.h>

struct scene_inputs;

// Checks each moment of the frame's samples. In doubt a medium is needed; with objects, which send rays anywhere, all
// are.
void scene_visibility_find(const struct job *job, const struct scene_inputs *inputs, int32_t frame,
                           bool is_unneeded[static SCENE_MEDIUM_LIMIT]);
// Clears `is_unseen` of the media that a camera ray may meet at the frame's time. `inputs` may be those of another
// frame with the same files.
void scene_visibility_clear_seen(const struct job *job, const struct scene_inputs *inputs, int32_t frame,
                                 bool is_unseen[static SCENE_MEDIUM_LIMIT]);
