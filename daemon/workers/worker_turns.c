// SPDX-License-Identifier: Apache-2.0
#include "daemon/workers/worker_turns.h"

#include "core/base/log.h"
#include "daemon/farm/farm.h"
#include "daemon/nodes/node.h"
#include "daemon/settings/options.h"
#include "daemon/settings/pool_options.h"
#include "daemon/workers/worker_process.h"
#include "daemon/workers/worker_slot.h"
#include "node/memory_share.h"
#include "node/node_line.h"

#include <math.h>

// A worker stays with an owner for so many times what a change costs.
enum { STAY_CHANGES = 20, STAY_LEAST_MS = 200 };
// Of the mean: the weight of the latest change.
static const double NEWEST_SHARE = 0.125;

void worker_turns_finish(struct worker_turns *turns)
{
    job_fence_files_finish(&turns->asked);
}

static int64_t node_memory_limit(const struct pool_options *pool)
{
    if (pool->memory_bytes == 0) return NODE_MEMORY_SHARE;
    return pool->memory_bytes > 0 ? pool->memory_bytes : 0;
}

int64_t worker_turns_memory_limit(const struct worker_turns *turns, const struct worker_slot *slot)
{
    int64_t limit = turns->farm->options->worker_memory_bytes;

    if (slot->node) return node_memory_limit(node_pool(slot->node));
    if (limit != 0) return limit > 0 ? limit : 0;
    return turns->memory_bytes / turns->local_count;
}

void worker_turns_look_at_memory(struct worker_turns *turns)
{
    int64_t bytes = memory_share_find();

    if (bytes == turns->memory_bytes) return;
    turns->memory_bytes = bytes;
    if (turns->farm->options->worker_memory_bytes == 0)
        log_info("worker-memory: auto: %lld MiB for each worker", (long long)(bytes / turns->local_count) >> 20);
}

// A fenced worker goes on to serve jobs of the same owner which its fence opens, under the limits that hold now.
static bool serves(struct worker_turns *turns, const struct worker_slot *slot, const struct job_record *record)
{
    const struct worker_process *worker = slot->worker;

    if (!turns->farm->options->has_sandbox) return true;
    if (worker->fence && job_fence_is_old(worker->fence)) return false;
    if (worker->job == record->id) return true;
    return worker->fence && !record->needs_own_worker &&
           worker->memory_bytes == worker_turns_memory_limit(turns, slot) &&
           job_fence_opens(worker->fence, turns->farm, record, &turns->asked);
}

// Number of workers that will soon take a frame of the job: idle, starting, or making room for it; with `busy` also
// those that make room when their frames are done.
static int64_t count_coming(struct worker_turns *turns, const struct job_record *record, bool busy)
{
    int64_t count = 0;

    for (int i = 0; i < turns->slot_count; i++) {
        const struct worker_process *worker = turns->slots[i].worker;

        if (!worker || !turns_may_serve(&turns->slots[i].seat, &record->queued->turn)) continue;
        if (worker->state == WORKER_STOPPING || (busy && worker->in_flight.count > 0))
            count += worker->next_job == record->id;
        else
            count += worker->in_flight.count == 0 && serves(turns, &turns->slots[i], record);
    }
    return count;
}

struct job_record *worker_turns_choose(struct worker_turns *turns, struct worker_slot *slot)
{
    struct queue *queue = turns->farm->queue;
    struct queue_job *next;

    if (!turns->farm->options->has_sandbox) return NULL;
    while ((next = queue_choose_job(queue, &slot->seat))) {
        struct job_record *record = job_table_find(&turns->farm->jobs, next->id);
        bool may_start = record->failed_starts < WORKER_TURNS_START_LIMIT || record->is_last_start;

        if (may_start && count_coming(turns, record, false) < next->states.counts[FRAME_QUEUED]) {
            turns_sit(queue_turns(queue), &slot->seat, &next->turn, true);
            return record;
        }
        turns_cover(queue_turns(queue), &next->turn);
    }
    turns_stand(queue_turns(queue), &slot->seat);
    return NULL;
}

enum worker_fit worker_turns_fit(struct worker_turns *turns, struct worker_slot *slot, const struct queue_job *job)
{
    struct job_record *record = job_table_find(&turns->farm->jobs, job->id);
    struct worker_process *worker = slot->worker;
    bool is_busy = worker->in_flight.count > 0;

    worker->next_job = 0;
    if (serves(turns, slot, record)) return WORKER_FITS;
    if (record->failed_starts == WORKER_TURNS_START_LIMIT) record->is_last_start = true; // for this worker did start
    if (count_coming(turns, record, is_busy) >= job->states.counts[FRAME_QUEUED]) return WORKER_COVERED;
    worker->next_job = job->id;
    return is_busy ? WORKER_BUSY : WORKER_CHANGES;
}

void worker_turns_begin_change(struct worker_turns *turns, struct worker_slot *slot)
{
    (void)turns;
    slot->changing_ns = uv_hrtime();
}

void worker_turns_end_change(struct worker_turns *turns, struct worker_slot *slot)
{
    double seconds = (double)(uv_hrtime() - slot->changing_ns) * 1e-9;

    if (slot->changing_ns == 0) return;
    slot->changing_ns = 0;
    turns->change_s = turns->change_s > 0 ? turns->change_s + (seconds - turns->change_s) * NEWEST_SHARE : seconds;
    turns_set_stay_ms(queue_turns(turns->farm->queue),
                      (int64_t)fmax(STAY_LEAST_MS, turns->change_s * 1000 * STAY_CHANGES));
}

void worker_turns_charge(struct worker_slot *slot)
{
    uint64_t now_ns = uv_hrtime();

    if (slot->worker && slot->worker->in_flight.count > 0)
        turns_charge(&slot->seat, (double)(now_ns - slot->charged_ns) * 1e-9);
    slot->charged_ns = now_ns;
}
