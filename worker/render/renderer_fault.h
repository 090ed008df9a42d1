// Why a frame was not rendered.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

enum renderer_fault {
    RENDERER_FAULT_NONE,
    RENDERER_FAULT_JOB,      // the shader does not compile, a value is out of range, the scene needs more than GL has
    RENDERER_FAULT_FRAME,    // a file of this frame's cannot be read, or changed meanwhile
    RENDERER_FAULT_ENDLESS,  // its loops take more iterations than GL runs, this time and the next
    RENDERER_FAULT_MAJORANT, // a density is above the majorant that the job states, this time and the next
    RENDERER_FAULT_CONTEXT,  // the context is lost or not usable
    RENDERER_FAULT_STOPPED,  // on_progress asked for it
    RENDERER_FAULT_MISSED // over its tolerance, in finer steps too: worker/plan/tolerance says so, the renderer never
};

// True where no other rendering is to be tried: it was stopped, or no context is left.
static inline bool renderer_fault_is_final(enum renderer_fault fault)
{
    return fault == RENDERER_FAULT_STOPPED || fault == RENDERER_FAULT_CONTEXT;
}
