// How many workers there are for a job, and why there is none.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/schedule/turns.h"
#include "daemon/workers/worker_slot.h"

#include <stdint.h>

struct job_record;

// Slots by the kinds of their seats and their states.
struct worker_counts {
    int slots[TURNS_KIND_LIMIT][WORKER_SLOT_STATE_COUNT];
};

// Counts the workers that can be assigned frames, by the kinds of their seats.
void worker_counts_find_ready(const struct worker_slot *slots, int slot_count, int ready[static TURNS_KIND_LIMIT]);
struct worker_counts worker_counts_of(const struct worker_slot *slots, int slot_count);
// Counts the nodes that take workers, and those that are waited for.
void worker_counts_find_nodes(const struct worker_slot *slots, int slot_count, int *up, int *waiting);
// Of the slots whose kinds are not barred, those that do not back off: ready, or soon.
int worker_counts_find_usable(const struct worker_slot *slots, int slot_count, uint64_t barred, int64_t now_ms);
// Why no worker can be assigned frames of the job (NULL: of any); NULL when one can. Owned by the caller.
char *worker_counts_format_trouble(const struct worker_slot *slots, int slot_count, const struct job_record *record);
