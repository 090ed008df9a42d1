// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/states.h"

#include <stddef.h>

const char *const job_state_names[] = {"queued", "running", "paused", "succeeded", "failed", "canceled", NULL};
const char *const frame_state_names[] = {"queued", "running", "succeeded", "failed", "canceled", "skipped", NULL};

const char *job_state_name(enum job_state state)
{
    return job_state_names[state];
}

const char *frame_state_name(enum frame_state state)
{
    return frame_state_names[state];
}
