// Deletes a job that is over, with its files where the client asks for it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct answer;
struct farm;
struct job_record;

struct job_delete_params {
    bool with_files;
    const char *user;           // copied; names the client
    struct answer *answer;      // taken over; NULL: nobody waits for one
    void (*on_end)(void *user); // called when the deletion was committed, or failed; may be NULL
    void *end_user;
};

// The answer is sent when the deletion is committed, or failed. One deletion is worked on at a time, and only after its
// job is swept. The job must be over, without another deletion or a waiting retry.
void job_delete_start(struct farm *farm, struct job_record *record, const struct job_delete_params *params);
void job_delete_go_on(struct farm *farm); // to be called when a job is swept
