// SPDX-License-Identifier: Apache-2.0
#include "daemon/workers/worker_pool.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/shares.h"
#include "daemon/settings/options.h"
#include "daemon/workers/job_fence.h"
#include "daemon/workers/worker_clock.h"
#include "daemon/workers/worker_counts.h"
#include "daemon/workers/worker_nodes.h"
#include "daemon/workers/worker_slot.h"
#include "daemon/workers/worker_turns.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum { TICK_MS = 250, EXIT_MS = 5000 };

struct worker_pool {
    struct farm *farm;                           // borrowed; outlives us
    const struct worker_pool_handlers *handlers; // borrowed; outlive us
    struct worker_handlers process_handlers;
    uv_timer_t tick;
    struct worker_slot *slots;   // owned
    int slot_count, local_count; // those of this machine come first
    struct worker_nodes nodes;   // owned
    struct worker_turns turns;   // owned
    bool is_stopping;
    bool has_warned; // of workers whose fence lets files be opened
};

static void on_tick(uv_timer_t *tick);
static void on_report(void *user, struct worker_process *worker, const struct worker_report *report);
static void on_gone(void *user, struct worker_process *worker);
static void on_node_change(void *user, struct node *node);

static const struct node_handlers node_handlers = {.on_change = on_node_change, .list_roots = worker_nodes_list_roots};

struct worker_pool *worker_pool_create(struct farm *farm, int local_count, const struct worker_pool_handlers *handlers)
{
    struct worker_pool *pool = xcalloc(1, sizeof *pool);
    int slot_count = local_count + worker_nodes_count_slots(farm->options);

    pool->farm = farm;
    pool->handlers = handlers;
    pool->process_handlers = (struct worker_handlers){.on_report = on_report, .on_gone = on_gone, .user = pool};
    pool->slots = xcalloc((size_t)slot_count, sizeof pool->slots[0]);
    pool->slot_count = slot_count;
    pool->local_count = local_count;
    pool->turns =
        (struct worker_turns){.farm = farm, .slots = pool->slots, .slot_count = slot_count, .local_count = local_count};
    worker_nodes_make(&pool->nodes, farm, pool->slots + local_count, &node_handlers);
    uv_timer_init(farm->loop, &pool->tick);
    pool->tick.data = pool;
    return pool;
}

static struct worker_slot *slot_of(struct worker_pool *pool, const struct worker_process *worker)
{
    return &pool->slots[worker->id - 1];
}

// NULL when the job cannot be served: it is refused.
static struct job_fence *make_fence(struct worker_pool *pool, struct job_record *record)
{
    struct error error = {0};
    struct job_fence *fence = job_fence_create(pool->farm, record, &error);

    if (!fence) pool->handlers->on_job_refused(pool->farm, record, RETRY_FAULT_JOB, error.message);
    return fence;
}

static void start_worker(struct worker_pool *pool, int index)
{
    struct worker_slot *slot = &pool->slots[index];
    struct job_record *record = worker_turns_choose(&pool->turns, slot);
    struct json_writer first = {0};
    const struct options *options = pool->farm->options;
    struct worker_params params = {.child = {.program = options->worker_program,
                                             .backend = options->backend,
                                             .shader_folder = options->shader_folder,
                                             .thread_count = options->thread_count,
                                             .memory_bytes = worker_turns_memory_limit(&pool->turns, slot),
                                             .has_sandbox = options->has_sandbox},
                                   .progress_limit_ms = options->progress_limit_ms,
                                   .fence = record ? make_fence(pool, record) : NULL,
                                   .first = &first,
                                   .id = index + 1};
    struct log_subject subject = {.worker = index + 1};
    struct error error = {0};
    char device[16];

    // Workers share the GPUs. Those of a node get their turns there.
    snprintf(device, sizeof device, "turn:%d", index % 10000);
    if (!slot->node) params.child.device = device;
    params.node = slot->node;
    if (slot->node) worker_nodes_set_params(slot->node, &params.child);
    if (record && params.fence) {
        params.job = record->id;
        params.child.is_fenced = true;
        job_fence_write(params.fence, pool->farm, &first);
    }
    slot->worker = worker_process_start(pool->farm->loop, &params, &pool->process_handlers, &error);
    if (slot->worker) {
        log_about(LOG_DEBUG, &subject, "worker %d: started, pid %d", index + 1, worker_process_pid(slot->worker));
    } else {
        retry_backoff_fail(&slot->backoff, farm_now_ms(pool->farm));
        worker_slot_set_reason(slot, xstrdup(error.message));
        log_about(LOG_WARN, &subject, "worker %d: %s", index + 1, error.message);
    }
    json_writer_finish(&first);
    pool->handlers->on_slot_changed(pool->farm, index);
}

static void start_due(struct worker_pool *pool)
{
    int64_t now_ms = farm_now_ms(pool->farm);

    for (int i = 0; i < pool->slot_count && !pool->is_stopping; i++) {
        struct worker_slot *slot = &pool->slots[i];

        if (slot->worker || !worker_nodes_are_ready(slot)) continue;
        if (retry_backoff_wait_ms(&slot->backoff, now_ms) > 0) continue;
        if (!slot->node) worker_turns_look_at_memory(&pool->turns);
        start_worker(pool, i);
    }
    turns_uncover(queue_turns(pool->farm->queue));
}

// Its workers are started as soon as it takes them; a slot without one tells why.
static void on_node_change(void *user, struct node *node)
{
    const struct farm *farm = user;
    struct worker_pool *pool = farm->pool;

    for (int i = pool->local_count; i < pool->slot_count; i++)
        if (pool->slots[i].node == node && !pool->slots[i].worker) pool->handlers->on_slot_changed(pool->farm, i);
    if (node_state(node) == NODE_READY) start_due(pool);
}

void worker_pool_start(struct worker_pool *pool)
{
    worker_nodes_check(&pool->nodes, farm_now_ms(pool->farm));
    start_due(pool);
    uv_timer_start(&pool->tick, on_tick, TICK_MS, TICK_MS);
}

static void on_tick(uv_timer_t *tick)
{
    struct worker_pool *pool = tick->data;
    int64_t now_ms = farm_now_ms(pool->farm);

    shares_tick(pool->farm);
    for (int i = 0; i < pool->slot_count; i++) {
        worker_turns_charge(&pool->slots[i]);
        if (pool->slots[i].worker) worker_clock_check(pool->farm, pool->slots[i].worker, now_ms);
        if (pool->slots[i].worker) worker_process_check(pool->slots[i].worker, now_ms);
    }
    worker_nodes_check(&pool->nodes, farm_now_ms(pool->farm));
    start_due(pool);
}

static void note_start(const struct worker_pool *pool, const struct worker_process *worker)
{
    struct job_record *record = job_table_find(&pool->farm->jobs, worker->job);

    if (!record) return;
    record->failed_starts = 0;
    record->is_last_start = false;
}

// Pauses a job whose workers do not start while others do: it would keep the frames of other jobs waiting.
static void note_failed_start(const struct worker_pool *pool, const struct worker_process *worker, const char *reason)
{
    struct job_record *record = job_table_find(&pool->farm->jobs, worker->job);
    char *why;

    if (!record || pool->is_stopping) return;
    if (!record->is_last_start) {
        if (record->failed_starts < WORKER_TURNS_START_LIMIT) record->failed_starts++;
        return;
    }
    record->failed_starts = 0;
    record->is_last_start = false;
    why = xasprintf("workers start for other jobs, but not for this one: %s", reason);
    pool->handlers->on_job_refused(pool->farm, record, RETRY_FAULT_WORKER, why);
    free(why);
}

// Said once: workers for jobs start often.
static void warn_of_weak_fence(struct worker_pool *pool, const struct worker_process *worker)
{
    if (pool->has_warned || !worker->fence || !worker->sandbox || strncmp(worker->sandbox, "landlock ", 9) == 0) return;
    pool->has_warned = true;
    log_warn("workers have no fence around files (%s): a job that takes over its worker reaches what marchd may open",
             worker->sandbox);
}

static void note_ready(struct worker_pool *pool, struct worker_process *worker, const struct worker_report *report)
{
    if (worker->state != WORKER_STARTING) return;
    liveness_ready(&worker->liveness, farm_now_ms(pool->farm));
    worker_process_note_ready(worker, report);
    worker_turns_end_change(&pool->turns, slot_of(pool, worker));
    note_start(pool, worker);
    warn_of_weak_fence(pool, worker);
    // A worker for one job starts often, so its start is logged at debug level only.
    log_about(worker->job ? LOG_DEBUG : LOG_INFO,
              &(struct log_subject){.worker = worker->id, .job = worker->job > 0 ? worker->job : 0},
              "worker %d: ready: %s on %s (%s)", worker->id, report->backend, report->renderer, report->version);
    worker_slot_set_reason(slot_of(pool, worker), NULL);
    pool->handlers->on_slot_changed(pool->farm, worker->id - 1);
    farm_want_feed(pool->farm);
}

// A worker that cannot be fenced in for its job is not at fault itself.
static void note_unable(struct worker_pool *pool, struct worker_process *worker, const struct worker_report *report,
                        int64_t now_ms)
{
    struct job_record *record = job_table_find(&pool->farm->jobs, worker->job);

    if (!worker->end_reason) worker->end_reason = xstrdup(report->error);
    if (worker->job != WORKER_ANY_JOB && worker->state == WORKER_STARTING && report->fault != RETRY_FAULT_WORKER) {
        worker->is_replaced = true;
        if (worker->node && report->fault == RETRY_FAULT_ROOT)
            node_look_at_roots(worker->node);
        else if (record)
            pool->handlers->on_job_refused(pool->farm, record, report->fault, report->error);
    }
    worker_process_expect_exit(worker, now_ms + EXIT_MS);
}

static void on_report(void *user, struct worker_process *worker, const struct worker_report *report)
{
    struct worker_pool *pool = user;
    int64_t now_ms = farm_now_ms(pool->farm);

    worker_turns_charge(slot_of(pool, worker));
    worker_process_note_clocks(worker, report, now_ms);
    if (report->kind == WORKER_REPORT_READY) note_ready(pool, worker, report);
    if (report->kind == WORKER_REPORT_UNABLE) note_unable(pool, worker, report, now_ms);
    if (report->kind >= WORKER_REPORT_STARTED && report->kind <= WORKER_REPORT_DROPPED)
        pool->handlers->on_frame_report(pool->farm, worker, report);
    if (report->kind == WORKER_REPORT_FINISHED || report->kind == WORKER_REPORT_SKIPPED)
        retry_backoff_succeed(&slot_of(pool, worker)->backoff);
    liveness_set_busy(&worker->liveness, worker->in_flight.count > 0, now_ms);
}

static void on_gone(void *user, struct worker_process *worker)
{
    struct worker_pool *pool = user;
    struct worker_slot *slot = slot_of(pool, worker);
    char *reason = worker_process_describe_end(worker);
    struct log_subject subject = worker_process_subject(worker);
    bool is_replaced = worker->is_replaced && worker->in_flight.count == 0 && worker->exit_signal == 0;
    bool is_expected = is_replaced || (pool->is_stopping && worker->exit_status == 0 && worker->exit_signal == 0);

    if (!is_expected) // the end of a node is told once
        log_about(worker->is_node_lost ? LOG_DEBUG : LOG_WARN, &subject, "worker %d: pid %d ended: %s", worker->id,
                  worker_process_pid(worker), reason);
    worker_turns_charge(slot);
    if (!is_replaced) turns_stand(queue_turns(pool->farm->queue), &slot->seat);
    pool->handlers->on_frames_lost(pool->farm, worker, reason);
    if (!worker->backend && !is_replaced && !worker->is_node_lost) note_failed_start(pool, worker, reason);
    slot->done += worker->done;
    slot->worker = NULL;
    // A frame that does not end is no fault of the slot, and the end of a node none of the worker.
    if (worker->done == 0 && !worker->is_node_lost && !worker->suspect_code && !worker->is_over_limit && !is_replaced)
        retry_backoff_fail(&slot->backoff, farm_now_ms(pool->farm));
    // The next worker of the slot is started below: nothing is wrong, and nothing to tell. What is wrong with a node is
    // told of the node.
    if ((is_replaced && !pool->is_stopping) || worker->is_node_lost) {
        free(reason);
        reason = NULL;
    }
    worker_slot_set_reason(slot, reason);
    if (reason) pool->handlers->on_slot_changed(pool->farm, worker->id - 1);
    worker_process_close(worker);
    farm_want_feed(pool->farm); // other workers may have left the next frames to it
    start_due(pool);
}

void worker_pool_set_progress_limit(struct worker_pool *pool, int64_t limit_ms)
{
    for (int i = 0; i < pool->slot_count; i++) {
        if (pool->slots[i].worker) pool->slots[i].worker->liveness.limits.progress_ms = limit_ms;
    }
}

void worker_pool_stop(struct worker_pool *pool, int64_t timeout_ms)
{
    int64_t stop_by_ms = farm_now_ms(pool->farm) + timeout_ms;

    pool->is_stopping = pool->nodes.is_stopping = true;
    for (int i = 0; i < pool->slot_count; i++) {
        struct worker_process *worker = pool->slots[i].worker;

        if (!worker) continue;
        if (worker->state == WORKER_STARTING)
            worker_process_kill(worker, "the daemon stops");
        else
            worker_process_exit(worker, stop_by_ms);
        pool->handlers->on_slot_changed(pool->farm, i);
    }
}

bool worker_pool_is_empty(const struct worker_pool *pool)
{
    for (int i = 0; i < pool->slot_count; i++)
        if (pool->slots[i].worker) return false;
    return true;
}

void worker_pool_close(struct worker_pool *pool)
{
    assert(worker_pool_is_empty(pool));
    worker_nodes_stop(&pool->nodes);
    uv_close((uv_handle_t *)&pool->tick, NULL);
}

void worker_pool_destroy(struct worker_pool *pool)
{
    if (!pool) return;
    for (int i = 0; i < pool->slot_count; i++)
        worker_slot_finish(&pool->slots[i]);
    free(pool->slots);
    worker_nodes_finish(&pool->nodes);
    worker_turns_finish(&pool->turns);
    free(pool);
}

int worker_pool_slot_count(const struct worker_pool *pool)
{
    return pool->slot_count;
}

struct worker_process *worker_pool_ready_at(const struct worker_pool *pool, int index)
{
    struct worker_process *worker = pool->slots[index].worker;

    return worker && worker->state == WORKER_READY ? worker : NULL;
}

bool worker_pool_is_behind(struct worker_pool *pool, int index)
{
    return worker_nodes_are_behind(&pool->nodes, &pool->slots[index]);
}

struct turns_seat *worker_pool_seat(struct worker_pool *pool, int index)
{
    return &pool->slots[index].seat;
}

double worker_pool_left_s(const struct worker_pool *pool, int index)
{
    return worker_nodes_left_s(&pool->slots[index], farm_now_ms(pool->farm));
}

void worker_pool_note_short(struct worker_pool *pool, int index, double frame_s)
{
    worker_nodes_note_short(&pool->slots[index], frame_s);
}

void worker_pool_charge(struct worker_pool *pool, int index)
{
    worker_turns_charge(&pool->slots[index]);
}

// The next worker in its slot serves another job.
static void replace(struct worker_pool *pool, struct worker_process *worker)
{
    worker->is_replaced = true;
    worker_turns_begin_change(&pool->turns, slot_of(pool, worker));
    worker_process_exit(worker, farm_now_ms(pool->farm) + EXIT_MS);
}

// A worker that has nothing to do does not stay where other owners' files are.
static void leave_if_shared(struct worker_pool *pool, struct worker_process *worker)
{
    if (worker->state == WORKER_READY && worker->in_flight.count == 0 && worker->fence &&
        job_fence_is_shared(worker->fence))
        replace(pool, worker);
}

void worker_pool_note_job(struct worker_pool *pool, const struct job_record *record)
{
    for (int i = 0; i < pool->slot_count; i++) {
        struct worker_process *worker = pool->slots[i].worker;

        if (worker && worker->fence && job_fence_note_job(worker->fence, record)) leave_if_shared(pool, worker);
    }
}

enum worker_fit worker_pool_prepare(struct worker_pool *pool, int index, struct queue_job *job)
{
    struct worker_slot *slot = &pool->slots[index];
    enum worker_fit fit = worker_turns_fit(&pool->turns, slot, job);

    if (fit != WORKER_CHANGES) return fit;
    turns_sit(queue_turns(pool->farm->queue), &slot->seat, &job->turn, true);
    replace(pool, slot->worker);
    return fit;
}

void worker_pool_count_ready(const struct worker_pool *pool, int ready[static TURNS_KIND_LIMIT])
{
    worker_counts_find_ready(pool->slots, pool->slot_count, ready);
}

struct worker_counts worker_pool_count_slots(const struct worker_pool *pool)
{
    return worker_counts_of(pool->slots, pool->slot_count);
}

void worker_pool_count_nodes(const struct worker_pool *pool, int *up, int *waiting)
{
    worker_counts_find_nodes(pool->slots, pool->slot_count, up, waiting);
}

int worker_pool_usable_count(const struct worker_pool *pool, uint64_t barred)
{
    return worker_counts_find_usable(pool->slots, pool->slot_count, barred, farm_now_ms(pool->farm));
}

char *worker_pool_format_trouble(const struct worker_pool *pool, const struct job_record *record)
{
    if (pool->is_stopping) return xstrdup("the daemon is stopping");
    return worker_counts_format_trouble(pool->slots, pool->slot_count, record);
}

struct worker_process *worker_pool_find_holder(const struct worker_pool *pool, int64_t job, int32_t frame,
                                               int32_t attempt)
{
    for (int i = 0; i < pool->slot_count; i++) {
        struct worker_process *worker = pool->slots[i].worker;

        if (worker && in_flight_find(&worker->in_flight, job, frame, attempt)) return worker;
    }
    return NULL;
}

const struct in_flight_frame *worker_pool_furthest_frame(const struct worker_pool *pool, int64_t job)
{
    const struct in_flight_frame *furthest = NULL;

    for (int i = 0; i < pool->slot_count; i++) {
        const struct worker_process *worker = pool->slots[i].worker;
        const struct in_flight_frame *frame = worker ? in_flight_furthest(&worker->in_flight, job) : NULL;

        if (frame && (!furthest || frame->phase > furthest->phase)) furthest = frame;
    }
    return furthest;
}

void worker_pool_drop_job(struct worker_pool *pool, int64_t job, bool running)
{
    for (int i = 0; i < pool->slot_count; i++) {
        struct worker_process *worker = pool->slots[i].worker;

        if (worker && in_flight_has_job(&worker->in_flight, job)) worker_process_drop_job(worker, job, running);
    }
}

void worker_pool_tell(struct worker_pool *pool, int64_t job, const struct json_writer *messages)
{
    for (int i = 0; i < pool->slot_count; i++) {
        struct worker_process *worker = pool->slots[i].worker;

        if (worker && worker_process_knows_job(worker, job)) worker_process_send(worker, messages);
    }
}

void worker_pool_forget_job(struct worker_pool *pool, int64_t job)
{
    for (int i = 0; i < pool->slot_count; i++) {
        struct worker_process *worker = pool->slots[i].worker;

        if (!worker) continue;
        // A retried job needs a new worker: the files that this one opened may be gone.
        if (worker->job == job) worker->job = WORKER_NO_JOB;
        if (!worker_process_knows_job(worker, job)) continue;
        worker_process_forget_job(worker, job);
        leave_if_shared(pool, worker);
    }
}

void worker_pool_write_slot(const struct worker_pool *pool, int index, struct json_writer *writer)
{
    worker_slot_write(&pool->slots[index], index + 1, writer);
}
