// Which job each worker slot serves, and when its worker makes room for another job's.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/workers/job_fence.h"

#include <stdint.h>

struct farm;
struct job_record;
struct queue_job;
struct worker_process;
struct worker_slot;

// Failed starts for a job; further ones wait until a worker for another job starts.
enum { WORKER_TURNS_START_LIMIT = 3 };

enum worker_fit {
    WORKER_FITS,    // it can be assigned frames of the job
    WORKER_BUSY,    // it makes room for the job when its frames in flight are done
    WORKER_CHANGES, // it is to exit now: the next worker in its slot serves the job
    WORKER_COVERED  // other workers are about to take all frames of the job
};

// The zero value with farm, slots and slot_count set is ready.
struct worker_turns {
    struct farm *farm;            // borrowed; outlives us
    struct worker_slot *slots;    // borrowed; outlive us
    int slot_count, local_count;  // slots, and those of this machine, which come first
    struct job_fence_files asked; // owned; of the latest job that a worker might go on to
    int64_t memory_bytes;         // what the workers here may take together, as it was when one was last started
    double change_s;              // mean of what a change took lately; 0: unknown
};

void worker_turns_finish(struct worker_turns *turns);
// Of the slot's worker, in bytes; 0: none, NODE_MEMORY_SHARE: its share of the node's.
int64_t worker_turns_memory_limit(const struct worker_turns *turns, const struct worker_slot *slot);
// To be called before a worker is started here: the limits of the control group may have changed.
void worker_turns_look_at_memory(struct worker_turns *turns);
// The job that the next worker in the slot is started for; NULL: it serves any job, or none for now.
struct job_record *worker_turns_choose(struct worker_turns *turns, struct worker_slot *slot);
// Whether the slot's worker, which is ready, can serve the job that was chosen for it. The caller obeys.
enum worker_fit worker_turns_fit(struct worker_turns *turns, struct worker_slot *slot, const struct queue_job *job);
// Notes that the slot's worker was told to exit, and that the next is ready: how long workers stay depends on it.
void worker_turns_begin_change(struct worker_turns *turns, struct worker_slot *slot);
void worker_turns_end_change(struct worker_turns *turns, struct worker_slot *slot);
// Charges the owner with the time since the latest call, if the worker had frames in flight.
void worker_turns_charge(struct worker_slot *slot);
