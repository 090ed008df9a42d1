// SPDX-License-Identifier: Apache-2.0
#include "core/wire/frame_phase.h"

#include <stddef.h>

const char *const frame_phase_names[FRAME_PHASE_COUNT + 1] = {
    [FRAME_PHASE_NONE] = "none", [FRAME_PHASE_ENCODE] = "encode", [FRAME_PHASE_LINK] = "link",
    [FRAME_PHASE_PLAN] = "plan", [FRAME_PHASE_RENDER] = "render", [FRAME_PHASE_AUDIT] = "audit",
    [FRAME_PHASE_COUNT] = NULL,
};
