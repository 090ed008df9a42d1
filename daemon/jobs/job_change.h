// What a client may do to a job it submitted: pause, resume, cancel, retry, give another priority.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/frame_range.h"

struct answer;
struct farm;
struct job_record;

// Each changes the job at once; the caller stores it. `user` is who asks.
void job_change_pause(struct farm *farm, struct job_record *record, const char *user);
void job_change_resume(struct farm *farm, struct job_record *record);
void job_change_cancel(struct farm *farm, struct job_record *record, const char *user);
void job_change_set_priority(struct farm *farm, struct job_record *record, int priority);

// Which frames to queue again.
struct job_retry_params {
    unsigned states;          // bits
    struct frame_range range; // moves in; empty: all
    bool by_admin;            // who asks has no limits
    struct answer *answer;    // owned
};

// Queues them, commits that, and sends the answer, which is a refusal when the owner would have too much. A job whose
// leftovers are being removed is retried when that is done.
void job_change_retry(struct farm *farm, struct job_record *record, const struct job_retry_params *params);
void job_change_retry_waiting(struct farm *farm, struct job_record *record); // its leftovers are removed
