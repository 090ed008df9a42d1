// The slots that workers run in: starts them, watches their clocks, starts them again, stops them all.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/workers/worker_process.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct farm;
struct job_record;
struct json_writer;
struct queue_job;
struct worker_pool;

// What the pool hands on. A worker that is gone has its frames lost first, then its job refused if it could not start, then its
// slot cleared, and that told.
struct worker_pool_handlers {
    void (*on_frame_report)(struct farm *farm, struct worker_process *worker, const struct worker_report *report);
    // The worker is gone; the callee empties its in_flight.
    void (*on_frames_lost)(struct farm *farm, struct worker_process *worker, const char *reason);
    // No worker starts for the job: by its own fault, or not.
    void (*on_job_refused)(struct farm *farm, struct job_record *record, bool is_job_fault, const char *reason);
    void (*on_slot_changed)(struct farm *farm, int slot_index);
};

// `handlers` is borrowed and outlives the pool.
struct worker_pool *worker_pool_create(struct farm *farm, int slot_count, const struct worker_pool_handlers *handlers);
void worker_pool_start(struct worker_pool *pool);
void worker_pool_set_progress_limit(struct worker_pool *pool, int64_t limit_ms); // of workers that run
// Tells all workers to exit; those still here after `timeout_ms` are killed.
void worker_pool_stop(struct worker_pool *pool, int64_t timeout_ms);
bool worker_pool_is_empty(const struct worker_pool *pool); // no process is left
void worker_pool_close(struct worker_pool *pool);          // legal once it is empty
void worker_pool_destroy(struct worker_pool *pool);        // after the loop closed its handles; accepts NULL

int worker_pool_slot_count(const struct worker_pool *pool);
int worker_pool_ready_count(const struct worker_pool *pool);
// The worker in slot `index` that may be given frames, else NULL.
struct worker_process *worker_pool_ready_at(const struct worker_pool *pool, int index);
// Whether frames of the job go to the worker as it is. If not, and its hand is empty and no other worker is about to take
// them, it is told to exit, for one that serves that job to take its place.
bool worker_pool_suits(struct worker_pool *pool, struct worker_process *worker, const struct queue_job *job);
// Why no worker can be given frames; NULL when one can. Owned by the caller.
char *worker_pool_format_trouble(const struct worker_pool *pool);

// To every worker that knows the job, or holds frames of it: worker.drop, worker.forget.
void worker_pool_drop_job(struct worker_pool *pool, int64_t job, bool running);
void worker_pool_forget_job(struct worker_pool *pool, int64_t job);

// The slot as clients see it: the object *worker* of docs/protocol.md.
void worker_pool_write_slot(const struct worker_pool *pool, int index, struct json_writer *writer);
