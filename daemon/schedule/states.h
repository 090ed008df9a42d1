// The states of jobs and frames, and their names.
// SPDX-License-Identifier: Apache-2.0
#pragma once

enum job_state {
    JOB_QUEUED, // none of its frames has started
    JOB_RUNNING,
    JOB_PAUSED,
    JOB_SUCCEEDED,
    JOB_FAILED,
    JOB_CANCELED,
    JOB_STATE_COUNT
};

enum frame_state {
    FRAME_QUEUED,
    FRAME_RUNNING,
    FRAME_SUCCEEDED,
    FRAME_FAILED,
    FRAME_CANCELED,
    FRAME_SKIPPED,
    FRAME_STATE_COUNT
};

const char *job_state_name(enum job_state state);
const char *frame_state_name(enum frame_state state);
extern const char *const job_state_names[];   // end in NULL
extern const char *const frame_state_names[]; // end in NULL
