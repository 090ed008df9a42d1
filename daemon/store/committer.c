// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/committer.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "daemon/metrics/histogram.h"
#include "daemon/store/store.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum { RETRY_MS = 1000 };

// One call of committer_put: the ops [first, first + count) of a batch, and the callback.
struct commit_entry {
    size_t first, count;
    enum commit_policy policy;
    committer_on_done *on_done;
    void *user; // borrowed
};

struct commit_batch {
    struct store_op *ops; // owned
    size_t op_count, op_capacity;
    struct commit_entry *entries; // owned
    size_t entry_count, entry_capacity;
    uint64_t since_ns; // monotonic; when the first of the ops was put
};

struct committer {
    uv_loop_t *loop;     // borrowed; outlives us
    struct store *store; // borrowed; outlives us
    uv_timer_t retry_timer;
    uv_work_t work;
    struct commit_batch gathering, in_flight;
    bool is_working;           // `work` is queued: its thread uses in_flight, and reads `trouble`
    bool is_due;               // a try is due, even without ops
    bool result, probe_result; // set by the thread
    struct error error;        // set by the thread: of the commit or the probe
    struct histogram seconds;
    bool has_failed;      // the latest commit failed
    struct error trouble; // empty: none
    committer_on_trouble *on_trouble;
    void *watcher; // borrowed
};

static void start_batch(struct committer *committer);
static void on_commit_run(uv_work_t *work);
static void on_commit_done(uv_work_t *work, int status);
static void on_retry(uv_timer_t *timer);

static void set_trouble(struct committer *committer, const struct error *trouble)
{
    if (trouble->message[0]) uv_timer_start(&committer->retry_timer, on_retry, RETRY_MS, 0);
    if (strcmp(committer->trouble.message, trouble->message) == 0) return;
    if (trouble->message[0])
        log_error("%s", trouble->message);
    else
        log_info("store: commits again");
    committer->trouble = *trouble;
    if (committer->on_trouble) committer->on_trouble(committer->watcher);
}

static void note_no_reserve(struct committer *committer, const struct error *cause)
{
    struct error trouble;

    error_set(&trouble, "%s: what is in flight is stored, nothing new is begun until there is room", cause->message);
    set_trouble(committer, &trouble);
}

struct committer *committer_create(uv_loop_t *loop, struct store *store)
{
    struct committer *committer = xcalloc(1, sizeof *committer);

    committer->loop = loop;
    committer->store = store;
    uv_timer_init(loop, &committer->retry_timer);
    committer->retry_timer.data = committer;
    committer->work.data = committer;
    if (!store_has_reserve(store) && !store_probe(store, &committer->error))
        note_no_reserve(committer, &committer->error);
    return committer;
}

void committer_watch(struct committer *committer, committer_on_trouble *on_trouble, void *user)
{
    committer->on_trouble = on_trouble;
    committer->watcher = user;
}

static void batch_finish(struct commit_batch *batch)
{
    for (size_t i = 0; i < batch->op_count; i++)
        store_op_finish(&batch->ops[i]);
    free(batch->ops);
    free(batch->entries);
    *batch = (struct commit_batch){0};
}

void committer_destroy(struct committer *committer)
{
    if (!committer) return;
    assert(!committer->is_working);
    batch_finish(&committer->gathering);
    batch_finish(&committer->in_flight);
    free(committer);
}

void committer_put(struct committer *committer, enum commit_policy policy, struct store_op *ops, size_t op_count,
                   committer_on_done *on_done, void *user)
{
    struct commit_batch *batch = &committer->gathering;

    if (batch->entry_count == 0) batch->since_ns = uv_hrtime();
    if (op_count > 0) {
        batch->ops = xgrow(batch->ops, &batch->op_capacity, batch->op_count + op_count, sizeof *batch->ops);
        memcpy(batch->ops + batch->op_count, ops, op_count * sizeof *ops);
    }
    batch->entries = xgrow(batch->entries, &batch->entry_capacity, batch->entry_count + 1, sizeof *batch->entries);
    batch->entries[batch->entry_count++] = (struct commit_entry){
        .first = batch->op_count, .count = op_count, .policy = policy, .on_done = on_done, .user = user};
    batch->op_count += op_count;
    start_batch(committer);
}

void committer_flush(struct committer *committer, committer_on_done *on_done, void *user)
{
    if (committer_is_idle(committer))
        on_done(user, true, NULL);
    else
        committer_put(committer, COMMIT_REPORTED, NULL, 0, on_done, user);
}

size_t committer_waiting(const struct committer *committer)
{
    return committer->gathering.op_count + committer->in_flight.op_count;
}

const struct histogram *committer_seconds(const struct committer *committer)
{
    return &committer->seconds;
}

bool committer_is_idle(const struct committer *committer)
{
    return !committer->is_working && committer_waiting(committer) == 0;
}

const char *committer_trouble(const struct committer *committer)
{
    return committer->trouble.message[0] ? committer->trouble.message : NULL;
}

bool committer_has_failed(const struct committer *committer)
{
    return committer->has_failed;
}

void committer_close(struct committer *committer)
{
    uv_close((uv_handle_t *)&committer->retry_timer, NULL);
}

// Appends the new ops to those that failed before, so that callers get an answer while the store fails.
static void gather_into_flight(struct committer *committer)
{
    struct commit_batch *kept = &committer->in_flight, *batch = &committer->gathering;

    if (batch->op_count > 0) {
        kept->ops = xgrow(kept->ops, &kept->op_capacity, kept->op_count + batch->op_count, sizeof *kept->ops);
        memcpy(kept->ops + kept->op_count, batch->ops, batch->op_count * sizeof *kept->ops);
    }
    kept->entries =
        xgrow(kept->entries, &kept->entry_capacity, kept->entry_count + batch->entry_count, sizeof *kept->entries);
    for (size_t i = 0; i < batch->entry_count; i++) {
        kept->entries[kept->entry_count] = batch->entries[i];
        kept->entries[kept->entry_count++].first += kept->op_count;
    }
    kept->op_count += batch->op_count;
    batch->op_count = batch->entry_count = 0;
}

static void start_batch(struct committer *committer)
{
    if (committer->is_working || (committer->has_failed && !committer->is_due)) return;
    if (committer->in_flight.entry_count == 0) {
        struct commit_batch emptied = committer->in_flight;

        committer->in_flight = committer->gathering;
        committer->gathering = emptied;
    } else if (committer->gathering.entry_count > 0) {
        gather_into_flight(committer);
    }
    if (committer->in_flight.entry_count == 0 && !committer->is_due) return;
    committer->is_due = false;
    committer->is_working = true;
    uv_queue_work(committer->loop, &committer->work, on_commit_run, on_commit_done);
}

static void on_commit_run(uv_work_t *work)
{
    struct committer *committer = work->data;
    const struct commit_batch *batch = &committer->in_flight;

    committer->result = store_commit(committer->store, batch->ops, batch->op_count, &committer->error);
    committer->probe_result = committer->result;
    if (committer->result && (committer->trouble.message[0] || !store_has_reserve(committer->store)))
        committer->probe_result = store_probe(committer->store, &committer->error);
}

static void tell(const struct commit_entry *entry, bool ok, const struct error *error)
{
    if (entry->on_done) entry->on_done(entry->user, ok, error);
}

static void note_failure(struct committer *committer)
{
    struct error trouble;

    error_set(&trouble, "%s; nothing new is begun, tried again every second", committer->error.message);
    set_trouble(committer, &trouble);
}

static void end_success(struct committer *committer)
{
    // The callbacks put new ops, which start the next batch: in_flight must be free before.
    struct commit_batch batch = committer->in_flight;

    if (batch.op_count > 0)
        histogram_add(&committer->seconds, &histogram_latency_s, (double)(uv_hrtime() - batch.since_ns) / 1e9);
    committer->in_flight = (struct commit_batch){0};
    committer->has_failed = !committer->probe_result && store_has_reserve(committer->store);
    if (committer->has_failed)
        note_failure(committer);
    else if (!committer->probe_result)
        note_no_reserve(committer, &committer->error);
    else
        set_trouble(committer, &(struct error){0});
    start_batch(committer);
    for (size_t i = 0; i < batch.entry_count; i++)
        tell(&batch.entries[i], true, NULL);
    batch_finish(&batch);
}

// Drops the ops that are not tried again and calls back; the others wait for the retry timer.
static void end_failure(struct committer *committer)
{
    struct commit_batch batch = committer->in_flight;
    struct commit_batch kept = {0};
    struct error error = committer->error;

    committer->has_failed = true;
    note_failure(committer);
    kept.ops = xmalloc(batch.op_count * sizeof *kept.ops);
    kept.op_capacity = batch.op_count;
    kept.entries = xmalloc(batch.entry_count * sizeof *kept.entries);
    kept.entry_capacity = batch.entry_count;
    for (size_t i = 0; i < batch.entry_count; i++) {
        struct commit_entry entry = batch.entries[i];

        if (entry.policy == COMMIT_OR_DROP || entry.count == 0) {
            for (size_t op = 0; op < entry.count; op++)
                store_op_finish(&batch.ops[entry.first + op]);
            continue;
        }
        memcpy(kept.ops + kept.op_count, batch.ops + entry.first, entry.count * sizeof *kept.ops);
        entry.first = kept.op_count;
        kept.op_count += entry.count;
        if (entry.policy == COMMIT_REPORTED) entry.policy = COMMIT_SILENT;
        if (entry.policy == COMMIT_SILENT) entry.on_done = NULL;
        kept.entries[kept.entry_count++] = entry;
    }
    kept.since_ns = batch.since_ns;
    committer->in_flight = kept;
    for (size_t i = 0; i < batch.entry_count; i++) {
        if (batch.entries[i].policy == COMMIT_OR_DROP || batch.entries[i].policy == COMMIT_REPORTED)
            tell(&batch.entries[i], false, &error);
    }
    free(batch.ops);
    free(batch.entries);
}

static void on_commit_done(uv_work_t *work, int status)
{
    struct committer *committer = work->data;

    committer->is_working = false;
    if (committer->result)
        end_success(committer);
    else
        end_failure(committer);
}

static void on_retry(uv_timer_t *timer)
{
    struct committer *committer = timer->data;

    committer->is_due = true;
    start_batch(committer);
}
