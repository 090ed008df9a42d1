// What happens to jobs when their output root goes away or comes back, and when a frame cannot be written.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/schedule/retry.h"

struct farm;
struct job_record;
struct root;

// Why the output of a job is to be checked. Meanwhile none of its frames is taken.
enum root_life_cause {
    ROOT_LIFE_FOLDER_WANTED, // a user wants it to go on: its folder is made if it is missing
    ROOT_LIFE_OUTPUT_FAILED, // a frame could not be written: the job is held, unless the root has changed
    ROOT_LIFE_ROOT_FAILED,   // a worker did not find the root: the job goes on if it is there
    ROOT_LIFE_NODE_FAILED,   // a worker of a node did not find the root: whether it is there is looked at
    ROOT_LIFE_ROOT_BACK      // it has intents whose outcome the root knows
};

// Opens the job's folder off the loop, and settles the job's intents. If its root is not there, the jobs of that root
// wait for it. `why` is the text of the failure, NULL for none.
void root_life_check(struct farm *farm, struct job_record *record, enum root_life_cause cause, const char *why);
// The root was not there when files were published: its jobs wait until it is.
void root_life_lose(struct farm *farm, struct root *root, const char *why);
// To be called when a root is found to be there, or not to be there any more.
void root_life_note_change(struct farm *farm, struct root *root);
// To be called for each job when it is added: one whose root is not there waits.
void root_life_note_job(struct farm *farm, struct job_record *record);
// Sweeps a job that needs it (job_table.h) once its root is there.
void root_life_sweep_again(struct farm *farm, struct job_record *record);
// No worker can be started for the job: it waits for its root, is held, or fails if the fault is its own.
void root_life_refuse(struct farm *farm, struct job_record *record, enum retry_fault fault, const char *why);
