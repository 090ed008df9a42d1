// Makes the daemon forget a job that is over, and removes its files if that is asked for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct answer;
struct farm;
struct job_record;

// The answer comes when the store knows the job no more, or could not. One at a time is worked on; a job whose leftovers
// are still being removed waits for that. The job must be over, and neither being deleted nor about to live again.
void job_delete_start(struct farm *farm, struct job_record *record, bool with_files, struct answer *answer);
void job_delete_go_on(struct farm *farm); // a job's leftovers are removed
