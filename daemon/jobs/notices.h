// Stores what targets are to be told about a job: notices, which march-web asks for and delivers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job_notify.h"
#include "daemon/store/store_op.h"

#include <stdbool.h>

struct error;
struct farm;
struct job_record;

// What is to be told.
struct notice {
    struct job_record *record;
    enum job_notify_event event;
    const char *why; // why the job waits; NULL: what the job says
};

// Commits `op` and a notice for each target that wants the event, together.
void notices_store_with(struct farm *farm, const struct notice *notice, struct store_op op);
// The job is over and swept: commits `op`, which says so, with the notices of its end.
void notices_store_end(struct farm *farm, struct job_record *record, struct store_op op);
// Whether a rule of the job or of the settings wants the event.
bool notices_are_wanted(const struct farm *farm, const struct job_record *record, enum job_notify_event event);
// Reads what waits and what jobs have told, when jobs are restored and the epoch is known.
bool notices_restore(struct farm *farm, struct error *error);
// The notice is delivered or given up: an op that drops it.
struct store_op notices_drop(struct farm *farm, int64_t id);
