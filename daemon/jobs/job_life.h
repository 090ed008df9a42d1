// What follows from a change to a job: its start, its end, and faults that pause or fail it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct farm;
struct job_record;

// To be called after any change to a job or its frames. Counts what its owner has, sends events and notes the start. A
// job that ended is swept once none of its frames is in flight.
void job_life_note_change(struct farm *farm, struct job_record *record);
// To be called when the sweeper removed the part files of the job: its end is stored.
void job_life_note_swept(struct farm *farm, struct job_record *record, bool was_away);

// Pauses the job for a fault and stores that. Does nothing when it is paused or over.
void job_life_hold(struct farm *farm, struct job_record *record, const char *why);
// Fails the job with all its frames and stores that.
void job_life_fail(struct farm *farm, struct job_record *record, const char *why);
// To be called when no worker can be started for the job: it fails for a fault of its own, and is paused for any other.
void job_life_refuse(struct farm *farm, struct job_record *record, bool is_job_fault, const char *why);
