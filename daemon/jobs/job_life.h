// What follows from a change to a job: its start and its end, a fault that stops or fails it, who is told.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct farm;
struct job_record;

// To be called after any change to a job or its frames. Counts what its owner has, tells subscribers, notes that it started;
// a job that has ended, of which nobody holds a frame, has its leftovers swept.
void job_life_note_change(struct farm *farm, struct job_record *record);
// To be called when the sweeper removed the leftovers of the job: its end is stored.
void job_life_note_swept(struct farm *farm, struct job_record *record);

// The farm itself pauses the job, and stores that; nothing when it is paused or over.
void job_life_hold(struct farm *farm, struct job_record *record, const char *why);
// The job is failed with all its frames, and that is stored.
void job_life_fail(struct farm *farm, struct job_record *record, const char *why);
// No worker can be fenced in for the job: by its own fault it fails; by one of the output or the store it is paused.
void job_life_refuse(struct farm *farm, struct job_record *record, bool is_job_fault, const char *why);
