// The worker slots: starts workers, checks their time limits, replaces those that end, stops them all.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/schedule/turns.h"
#include "daemon/workers/worker_counts.h"
#include "daemon/workers/worker_process.h"
#include "daemon/workers/worker_turns.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct farm;
struct job_record;
struct json_writer;
struct queue_job;
struct worker_pool;

// Callbacks of the pool. When a worker is gone they come in this order: on_frames_lost, on_job_refused if it did not
// start for its job, and, after its slot is cleared, on_slot_changed.
struct worker_pool_handlers {
    void (*on_frame_report)(struct farm *farm, struct worker_process *worker, const struct worker_report *report);
    // The worker is gone; the callee empties its `in_flight`.
    void (*on_frames_lost)(struct farm *farm, struct worker_process *worker, const char *reason);
    // No worker can be started for the job.
    void (*on_job_refused)(struct farm *farm, struct job_record *record, enum retry_fault fault, const char *reason);
    void (*on_slot_changed)(struct farm *farm, int slot_index);
};

// `handlers` is borrowed and outlives the pool.
// `local_count` slots are of this machine; the nodes of the farm's options have further ones.
struct worker_pool *worker_pool_create(struct farm *farm, int local_count, const struct worker_pool_handlers *handlers);
void worker_pool_start(struct worker_pool *pool);
void worker_pool_set_progress_limit(struct worker_pool *pool, int64_t limit_ms); // also holds for running workers
// Tells all workers to exit; those that run after `timeout_ms` are killed.
void worker_pool_stop(struct worker_pool *pool, int64_t timeout_ms);
bool worker_pool_is_empty(const struct worker_pool *pool); // no worker process is left
void worker_pool_close(struct worker_pool *pool);          // legal once it is empty
void worker_pool_destroy(struct worker_pool *pool);        // after the loop closed its handles; accepts NULL

int worker_pool_slot_count(const struct worker_pool *pool);
// As the functions of worker_counts.h.
void worker_pool_count_ready(const struct worker_pool *pool, int ready[static TURNS_KIND_LIMIT]);
struct worker_counts worker_pool_count_slots(const struct worker_pool *pool);
void worker_pool_count_nodes(const struct worker_pool *pool, int *up, int *waiting);
int worker_pool_usable_count(const struct worker_pool *pool, uint64_t barred);
char *worker_pool_format_trouble(const struct worker_pool *pool, const struct job_record *record);
// The worker in slot `index` if it can be assigned frames, else NULL.
struct worker_process *worker_pool_ready_at(const struct worker_pool *pool, int index);
bool worker_pool_is_behind(struct worker_pool *pool, int index); // as worker_nodes_are_behind
// Whom the worker in slot `index` serves.
struct turns_seat *worker_pool_seat(struct worker_pool *pool, int index);
// As worker_nodes_left_s and worker_nodes_note_short, of slot `index`.
double worker_pool_left_s(const struct worker_pool *pool, int index);
void worker_pool_note_short(struct worker_pool *pool, int index, double frame_s);
void worker_pool_charge(struct worker_pool *pool, int index); // its owner, for the time up to now
// Whether the ready worker in slot `index` can be assigned frames of the job, which was chosen for its seat. With
// WORKER_CHANGES it was told to exit.
enum worker_fit worker_pool_prepare(struct worker_pool *pool, int index, struct queue_job *job);
// To be told of each job when it is queued: no worker of another owner stays idle where the job writes.
void worker_pool_note_job(struct worker_pool *pool, const struct job_record *record);

// The job's frame whose phase is the furthest; NULL: none. Valid until a frame is assigned or ends.
const struct in_flight_frame *worker_pool_furthest_frame(const struct worker_pool *pool, int64_t job);

// The worker that holds that attempt; NULL: none.
struct worker_process *worker_pool_find_holder(const struct worker_pool *pool, int64_t job, int32_t frame,
                                               int32_t attempt);
void worker_pool_tell(struct worker_pool *pool, int64_t job, const struct json_writer *messages); // who know the job

// Sends worker.drop to workers with frames of the job in flight, worker.forget to workers that know the job.
void worker_pool_drop_job(struct worker_pool *pool, int64_t job, bool running);
void worker_pool_forget_job(struct worker_pool *pool, int64_t job);

// The slot as clients see it: the object *worker* of docs/protocol.md.
void worker_pool_write_slot(const struct worker_pool *pool, int index, struct json_writer *writer);
