// SPDX-License-Identifier: Apache-2.0
#include "daemon/slurm/slurm_pool.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "daemon/nodes/node.h"
#include "daemon/nodes/node_launch.h"
#include "daemon/schedule/retry.h"
#include "daemon/settings/pool_options.h"
#include "daemon/settings/slurm_commands.h"
#include "daemon/slurm/allocations.h"
#include "daemon/slurm/slurm_call.h"
#include "daemon/slurm/slurm_lease.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    LOOK_FIRST_MS = 250,      // Slurm is looked at so often when something changes,
    LOOK_SOON_COUNT = 20,     // after so many looks
    LOOK_LAST_MS = 10 * 1000, // less and less often
    START_MS = 180 * 1000,    // a machine whose node is not ready for so long is given back
    LEASE_MOVES = 10          // moves in the time of the lease
};

// Where a node is.
struct placed {
    int64_t job;      // it is in; 0: none
    int64_t ready_ms; // when it was last ready, or began to be started
    bool was_ready, is_up;
};

enum call_kind { CALL_LOOK, CALL_ASK, CALL_CANCEL };

struct slurm_pool {
    uv_loop_t *loop;
    struct slurm_pool_params params;
    struct allocations allocations;
    struct slurm_lease *lease;
    struct placed *placed;   // owned; for each node
    struct slurm_call *call; // NULL: none runs
    enum call_kind kind;
    int index;        // of the allocation that the call is about
    int64_t asked_ms; // when the call began
    int64_t now_ms, look_ms, look_wait_ms, lease_ms;
    int look_count;  // since something was asked of Slurm
    int64_t stay_ms; // the longest time of an allocation
    int want;
    char idle_reason[160]; // why no more machines are wanted
    bool is_too_long;      // frames wait that no machine stays for
    char lease_told[128];  // what was said of the lease
    struct retry_backoff backoff;
    char *trouble; // owned; why Slurm cannot be used; NULL: it can
};

static void on_call_end(void *user, const struct slurm_answer *answer);
static void step(struct slurm_pool *slurm, bool is_checked);
static void place(struct slurm_pool *slurm, int index);

static const struct slurm_options *settings(const struct slurm_pool *slurm)
{
    return &slurm->params.pool->slurm;
}

struct slurm_pool *slurm_pool_create(uv_loop_t *loop, const struct slurm_pool_params *params)
{
    struct slurm_pool *slurm = xcalloc(1, sizeof *slurm);

    slurm->loop = loop;
    slurm->params = *params;
    slurm->look_wait_ms = LOOK_FIRST_MS;
    slurm->placed = xcalloc(params->pool->node_count, sizeof slurm->placed[0]);
    return slurm;
}

static void begin(struct slurm_pool *slurm)
{
    const struct pool_options *pool = slurm->params.pool;
    char *token = slurm_commands_format_token(pool, slurm->params.farm);
    char *folder = pool->slurm.lease_folder ? xstrdup(pool->slurm.lease_folder)
                                            : xasprintf("%s/.marchd-lease", slurm->params.output_root);

    allocations_init(&slurm->allocations, token, (int)pool->node_count);
    slurm->lease = slurm_lease_create(slurm->loop, folder, token);
    free(folder);
    free(token);
}

static void set_trouble(struct slurm_pool *slurm, char *trouble)
{
    bool is_news = trouble && (!slurm->trouble || strcmp(trouble, slurm->trouble) != 0);

    if (is_news) log_warn("pool %s: %s", slurm->params.pool->name, trouble);
    if (slurm->trouble && !trouble) log_info("pool %s: Slurm answers again", slurm->params.pool->name);
    free(slurm->trouble);
    slurm->trouble = trouble;
}

// Soon again, for something is about to change.
static void look_soon(struct slurm_pool *slurm)
{
    slurm->look_wait_ms = LOOK_FIRST_MS;
    slurm->look_count = 0;
    slurm->look_ms = slurm->now_ms + LOOK_FIRST_MS;
}

// `words` are of settings/pool_command.h.
static void call(struct slurm_pool *slurm, enum call_kind kind, int index, const char *const words[])
{
    const struct node_launch_order order = {
        .socket = slurm->params.launch_socket, .pool = slurm->params.pool, .words = words};
    struct error error = {0};

    slurm->kind = kind;
    slurm->index = index;
    slurm->asked_ms = slurm->now_ms;
    slurm->call = slurm_call_start(slurm->loop, &order, on_call_end, slurm, &error);
    if (!slurm->call) on_call_end(slurm, &(struct slurm_answer){.trouble = error.message});
}

static void look(struct slurm_pool *slurm)
{
    call(slurm, CALL_LOOK, 0, (const char *const[]){"look", slurm->params.farm, NULL});
}

static void ask(struct slurm_pool *slurm, int index)
{
    char number[12];

    snprintf(number, sizeof number, "%d", index + 1);
    allocations_note_asked(&slurm->allocations, index);
    call(slurm, CALL_ASK, index,
         (const char *const[]){"ask", slurm->params.farm, number, slurm_lease_path(slurm->lease), NULL});
}

static void cancel(struct slurm_pool *slurm, int index, int64_t job)
{
    char number[12], id[24];

    snprintf(number, sizeof number, "%d", index + 1);
    snprintf(id, sizeof id, "%lld", (long long)job);
    log_info("pool %s: cancels Slurm's job %s", slurm->params.pool->name, id);
    call(slurm, CALL_CANCEL, index, (const char *const[]){"cancel", slurm->params.farm, number, id, NULL});
}

static void give_back(struct slurm_pool *slurm, int index, const char *reason)
{
    const struct allocation *allocation = &slurm->allocations.all[index];
    int64_t job = allocation->job;

    allocations_note_canceled(&slurm->allocations, index, reason, slurm->now_ms);
    cancel(slurm, index, job);
    place(slurm, index); // it gets no more frames
}

static const char *or_silence(const char *trouble)
{
    return *trouble ? trouble : "it said nothing";
}

static void take_look(struct slurm_pool *slurm, const struct slurm_answer *answer)
{
    char *text = answer->is_whole ? answer->text : NULL;
    struct error error = {0};

    if (text && *text && allocations_take_answer(&slurm->allocations, text, slurm->asked_ms, &error)) {
        set_trouble(slurm, NULL);
    } else {
        // What it does not say is not known: everything stays as it was.
        set_trouble(slurm, xasprintf("Slurm does not answer: %s",
                                     error.message[0] ? error.message : or_silence(answer->trouble)));
    }
    slurm->look_ms = slurm->now_ms + slurm->look_wait_ms;
    if (++slurm->look_count < LOOK_SOON_COUNT) return;
    slurm->look_wait_ms = slurm->look_wait_ms * 3 / 2 < LOOK_LAST_MS ? slurm->look_wait_ms * 3 / 2 : LOOK_LAST_MS;
}

// A job that it names was taken, however sbatch ended.
static void take_job(struct slurm_pool *slurm, const struct slurm_answer *answer)
{
    const char *text = answer->text, *trouble = answer->trouble;
    struct error error = {0};
    int64_t job;
    char *reason;

    look_soon(slurm);
    if (text && slurm_read_job(text, &job, &error)) {
        log_info("pool %s: Slurm took job %lld", slurm->params.pool->name, (long long)job);
        allocations_note_job(&slurm->allocations, slurm->index, job, slurm->now_ms);
        return;
    }
    // What sbatch says begins with its name.
    if (*trouble)
        reason = xstrdup(trouble);
    else
        reason = xasprintf("sbatch: %s", text && *text ? error.message : "no answer");
    log_warn("pool %s: %s", slurm->params.pool->name, reason);
    allocations_note_silence(&slurm->allocations, slurm->index, reason, slurm->now_ms);
    retry_backoff_fail(&slurm->backoff, slurm->now_ms);
    free(reason);
}

static void on_call_end(void *user, const struct slurm_answer *answer)
{
    struct slurm_pool *slurm = user;
    struct slurm_call *call = slurm->call;

    slurm->now_ms = (int64_t)uv_now(slurm->loop);
    if (slurm->kind == CALL_LOOK) take_look(slurm, answer);
    if (slurm->kind == CALL_ASK) take_job(slurm, answer);
    if (slurm->kind == CALL_CANCEL) {
        if (*answer->trouble) log_warn("pool %s: %s", slurm->params.pool->name, answer->trouble);
        look_soon(slurm);
    }
    slurm_call_close(call);
    slurm->call = NULL;
    if (call) step(slurm, false);
}

static const char *trouble_of(const struct slurm_pool *slurm)
{
    return slurm->trouble ? slurm->trouble : slurm_lease_trouble(slurm->lease);
}

static void begin_place(struct slurm_pool *slurm, int index, int64_t job)
{
    struct placed *placed = &slurm->placed[index];
    const struct allocation *allocation = &slurm->allocations.all[index];

    if (placed->job && !allocation->cancel_ms && allocation->reason)
        log_warn("pool %s: %s", slurm->params.pool->name, allocation->reason);
    // One that ended before its node was ready: asked for again at once, the next would end likewise.
    if (placed->job && !placed->was_ready && !allocation->cancel_ms) retry_backoff_fail(&slurm->backoff, slurm->now_ms);
    *placed = (struct placed){.job = job, .ready_ms = slurm->now_ms};
}

// Why there is no node in it.
static const char *reason_of(const struct slurm_pool *slurm, const struct allocation *allocation)
{
    if (allocation->state == ALLOCATION_NONE && trouble_of(slurm)) return trouble_of(slurm);
    if (allocation->state == ALLOCATION_NONE && slurm->is_too_long) return slurm->idle_reason;
    return allocation->reason ? allocation->reason : slurm->idle_reason;
}

// The node lives where the allocation runs.
static void place(struct slurm_pool *slurm, int index)
{
    const struct allocation *allocation = &slurm->allocations.all[index];
    struct placed *placed = &slurm->placed[index];
    struct node *node = slurm->params.nodes[index];
    int64_t job = allocation->state == ALLOCATION_RUNS && !allocation->cancel_ms ? allocation->job : 0;
    const char *reason = reason_of(slurm, allocation);
    char text[24];

    if (job == 0 || job != placed->job) node_hold(node, reason, allocation->cancel_ms > 0);
    if (job != placed->job) begin_place(slurm, index, job);
    if (job == 0) return;
    snprintf(text, sizeof text, "%lld", (long long)job);
    node_allow(node, allocation->machine, text);
    node_set_stay(node, &(struct node_stay){.end_ms = allocation->end_ms, .whole_ms = allocation->whole_ms});
    if (allocation->whole_ms > slurm->stay_ms) slurm->stay_ms = allocation->whole_ms;
    if (placed->is_up && node_state(node) != NODE_READY) look_soon(slurm); // Slurm may know why
    placed->is_up = node_state(node) == NODE_READY;
    if (!placed->is_up) return;
    if (!placed->was_ready) retry_backoff_succeed(&slurm->backoff);
    placed->ready_ms = slurm->now_ms;
    placed->was_ready = true;
}

// A machine on which no node starts is of no use, and the next may be.
static bool give_back_useless(struct slurm_pool *slurm)
{
    for (int i = 0; i < slurm->allocations.count && !slurm->trouble; i++) {
        if (!slurm->placed[i].job || slurm->now_ms - slurm->placed[i].ready_ms < START_MS) continue;
        retry_backoff_fail(&slurm->backoff, slurm->now_ms);
        give_back(slurm, i, node_reason(slurm->params.nodes[i]));
        return true;
    }
    return false;
}

static bool has_any(const struct slurm_pool *slurm)
{
    return allocations_count(&slurm->allocations, ALLOCATION_NONE) < slurm->allocations.count;
}

// Begins the one call that is due. `is_checked`: what the workers have in hand was looked at in this turn. A machine
// that was idle at the last look may have frames since.
static void step(struct slurm_pool *slurm, bool is_checked)
{
    const struct allocations *allocations = &slurm->allocations;
    int index;

    for (int i = 0; i < allocations->count; i++)
        place(slurm, i);
    if (slurm->call) return;
    if (slurm->now_ms >= slurm->look_ms && (!allocations->is_known || slurm->trouble || has_any(slurm))) {
        look(slurm);
        return;
    }
    if (allocations->surplus_job) {
        int64_t job = allocations->surplus_job;

        slurm->allocations.surplus_job = 0;
        cancel(slurm, allocations->surplus_index, job);
        return;
    }
    if (give_back_useless(slurm)) return;
    index = allocations_find_to_cancel(allocations, slurm->want, settings(slurm)->idle_ms, slurm->now_ms);
    if (index >= 0 && !slurm->trouble && !is_checked) return;
    if (index >= 0 && !slurm->trouble) {
        if (allocations->all[index].is_short)
            log_info("pool %s: the rest of its time is too short", slurm->params.pool->name);
        give_back(slurm, index, NULL);
        return;
    }
    index = allocations_find_to_ask(allocations, slurm->want);
    if (index < 0 || !slurm_lease_is_held(slurm->lease) || trouble_of(slurm)) return;
    if (retry_backoff_wait_ms(&slurm->backoff, slurm->now_ms) == 0) ask(slurm, index);
}

void slurm_pool_note_busy(struct slurm_pool *slurm, int node, int64_t now_ms)
{
    if (!slurm->lease) return;
    slurm->allocations.all[node].busy_ms = now_ms;
    slurm->allocations.all[node].is_short = false; // another frame fitted
}

// An allocation ends by itself without the lease, so none is asked for before it is written.
static void hold_lease(struct slurm_pool *slurm)
{
    const char *trouble = slurm_lease_trouble(slurm->lease);

    if (slurm->now_ms < slurm->lease_ms) return;
    if (trouble && strncmp(trouble, slurm->lease_told, sizeof slurm->lease_told - 1) != 0)
        log_warn("pool %s: lease: %s", slurm->params.pool->name, trouble);
    snprintf(slurm->lease_told, sizeof slurm->lease_told, "%s", trouble ? trouble : "");
    slurm->lease_ms = slurm->now_ms + settings(slurm)->keep_ms / LEASE_MOVES;
    slurm_lease_move(slurm->lease);
}

void slurm_pool_note_short(struct slurm_pool *slurm, int node)
{
    if (slurm->lease) slurm->allocations.all[node].is_short = true;
}

double slurm_pool_stay_s(const struct slurm_pool *slurm)
{
    return (double)slurm->stay_ms / 1000;
}

static void set_idle_reason(struct slurm_pool *slurm, const struct slurm_need *need)
{
    int there = slurm->allocations.count - allocations_count(&slurm->allocations, ALLOCATION_NONE);

    slurm->is_too_long = need->tasks == 0 && need->too_long_s > 0;
    if (slurm->is_too_long)
        snprintf(slurm->idle_reason, sizeof slurm->idle_reason,
                 "a frame of the job takes %.0f s, Slurm's machines stay for %.0f s: pool %s needs a longer time",
                 need->too_long_s, slurm_pool_stay_s(slurm), slurm->params.pool->name);
    else
        snprintf(slurm->idle_reason, sizeof slurm->idle_reason, "%s",
                 slurm->want > there ? "it is not asked for yet" : "no frame waits for it");
}

void slurm_pool_check(struct slurm_pool *slurm, const struct slurm_need *need, int64_t now_ms)
{
    const struct slurm_options *options = settings(slurm);

    slurm->now_ms = now_ms;
    if (!slurm->lease) begin(slurm);
    slurm->want = allocations_want(need->tasks, slurm->params.pool->nodes[0].worker_count, options->min, options->max);
    set_idle_reason(slurm, need);
    hold_lease(slurm);
    step(slurm, true);
}

void slurm_pool_keep(struct slurm_pool *slurm, int64_t now_ms)
{
    slurm->now_ms = now_ms;
    if (slurm->lease) hold_lease(slurm);
}

void slurm_pool_stop(struct slurm_pool *slurm)
{
    slurm_call_close(slurm->call);
    slurm_lease_close(slurm->lease);
    slurm->call = NULL;
    slurm->lease = NULL;
}

void slurm_pool_destroy(struct slurm_pool *slurm)
{
    if (!slurm) return;
    allocations_finish(&slurm->allocations);
    free(slurm->placed);
    free(slurm->trouble);
    free(slurm);
}
