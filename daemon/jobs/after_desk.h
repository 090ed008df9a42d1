// Jobs that come after others: what they wait for, and when they go on.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct after_desk;
struct error;
struct farm;
struct job_after;
struct job_record;

struct after_desk *after_desk_create(struct farm *farm); // before the jobs are restored
void after_desk_destroy(struct after_desk *desk);        // accepts NULL
void after_desk_start(struct after_desk *desk);          // when the loop's turns are there: looks at restored jobs

// Whether all of them are known. Jobs are numbered as they come, so that none waits for a later one, or for itself.
bool after_desk_check(const struct farm *farm, const struct job_after *after, struct error *error);
// The job `waits` for those in `after`, and is in the queue as one that does. It is looked at in a turn of the loop.
void after_desk_add(struct farm *farm, struct job_record *record);
// To be called when a job may be over, or live again: those that come after it are looked at.
void after_desk_note_change(struct farm *farm, struct job_record *record);
void after_desk_forget(struct farm *farm, const struct job_record *record); // it is about to be removed
// The job waits no more, whatever it waits for. The caller stores it.
void after_desk_release(struct farm *farm, struct job_record *record);
bool after_desk_is_needed(const struct farm *farm, const struct job_record *record); // a live job waits for it
