// Changes that a client asks for: pause, resume, cancel, retry, priority.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/frame_range.h"

struct answer;
struct farm;
struct job_record;

// Each changes the job at once; the caller stores it. `user` names the client.
void job_change_pause(struct farm *farm, struct job_record *record, const char *user);
void job_change_resume(struct farm *farm, struct job_record *record, const char *user);
void job_change_cancel(struct farm *farm, struct job_record *record, const char *user);
void job_change_set_priority(struct farm *farm, struct job_record *record, int priority, const char *user);

// The frames to queue again.
struct job_retry_params {
    unsigned states;          // bits 1 << enum frame_state
    struct frame_range range; // moves in; empty: all frames
    bool is_forced;           // they are rendered even if their files are there and good
    const char *user;         // borrowed during the call; names the client
    bool by_admin;            // the client is an administrator, whom no limits hold
    struct answer *answer;    // owned
};

// Queues the frames, commits that, and sends the answer: an error when the owner would exceed a limit. A job that is
// being swept is retried after that.
void job_change_retry(struct farm *farm, struct job_record *record, const struct job_retry_params *params);
void job_change_retry_waiting(struct farm *farm, struct job_record *record); // to be called when the job is swept
