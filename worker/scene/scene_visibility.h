// Which media a frame can do without: no camera ray passes them, nor does light on its way to one that is passed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"

#include <stdbool.h>
#include <stdint.h>

struct scene_inputs;

// Looks at each moment that the frame's samples see. In doubt a medium is needed; where there are objects, which send rays
// anywhere, all are.
void scene_visibility_find(const struct job *job, const struct scene_inputs *inputs, int32_t frame,
                           bool is_unneeded[static SCENE_MEDIUM_LIMIT]);
