// Queues frames of a job again.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct answer;
struct farm;
struct job_record;

// The frames to queue again.
struct job_retry_params {
    unsigned states;       // bits 1 << enum frame_state
    const char *range;     // copied; as frame_range_parse reads it; NULL: all frames
    bool is_forced;        // they are rendered even if their files are there and good
    const char *user;      // borrowed during the call; names the client
    bool by_admin;         // the client is an administrator, whom no limits hold
    struct answer *answer; // owned
};

// Queues the frames and commits that, off the loop where it takes long, then sends the answer: how many they are, or an
// error when the range is wrong or the owner would exceed a limit. Retries of a job take turns, and wait while it is
// swept. Where many thousand frames have rows, they are queued part by part, each in one commit; a cancel between two
// parts ends the retry.
void job_retry_start(struct farm *farm, struct job_record *record, const struct job_retry_params *params);
void job_retry_go_on(struct farm *farm, struct job_record *record); // to be called when the job is swept
