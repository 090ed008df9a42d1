// SPDX-License-Identifier: Apache-2.0
#include "daemon/workers/worker_nodes.h"

#include "core/base/alloc.h"
#include "daemon/farm/farm.h"
#include "daemon/settings/options.h"
#include "daemon/settings/pool_options.h"
#include "daemon/slurm/slurm_pool.h"
#include "daemon/workers/worker_process.h"
#include "daemon/workers/worker_slot.h"
#include "node/node_probe.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

int worker_nodes_count_slots(const struct options *options)
{
    int count = 0;

    for (size_t i = 0; i < options->pools.count; i++)
        count += pool_options_worker_count(&options->pools.pools[i]);
    return count;
}

void worker_nodes_list_roots(void *user, struct node_probe *probe)
{
    const struct farm *farm = user;
    const struct path_list *inputs = &farm->options->input_roots;

    for (size_t i = 0; i < farm->roots.count; i++) {
        const struct root *root = farm->roots.roots[i];

        if (root->is_there && root->is_watched && root->id[0]) node_probe_add(probe, root->path, root->id);
    }
    for (size_t i = 0; i < inputs->count; i++)
        node_probe_add(probe, inputs->paths[i], "");
}

static void add_nodes(struct worker_nodes *nodes, const struct pool_options *pool, struct worker_slot *slots,
                      const struct node_handlers *handlers)
{
    for (size_t k = 0; k < pool->node_count; k++) {
        const struct node_params params = {.pool = pool,
                                           .name = pool->nodes[k].name,
                                           .version = nodes->farm->options->version,
                                           .looks = &nodes->looks,
                                           .launch_socket = nodes->farm->options->launch_socket,
                                           .worker_count = pool->nodes[k].worker_count};
        struct node *node = node_create(nodes->farm->loop, &params, handlers, nodes->farm);

        nodes->nodes[nodes->count++] = node;
        for (int worker = 0; worker < params.worker_count; worker++)
            (slots++)->node = node;
    }
}

static void add_site(struct worker_nodes *nodes, const struct pool_options *pool, struct worker_slot *slots)
{
    const struct slurm_pool_params params = {.pool = pool,
                                             .nodes = nodes->nodes + nodes->count - pool->node_count,
                                             .farm = nodes->farm->id,
                                             .output_root = nodes->farm->options->output_roots.paths[0],
                                             .launch_socket = nodes->farm->options->launch_socket};

    nodes->sites = xrealloc(nodes->sites, (nodes->site_count + 1) * sizeof nodes->sites[0]);
    nodes->sites[nodes->site_count++] = (struct worker_site){.slurm = slurm_pool_create(nodes->farm->loop, &params),
                                                             .slots = slots,
                                                             .slot_count = pool_options_worker_count(pool),
                                                             .worker_count = pool->nodes[0].worker_count};
}

void worker_nodes_make(struct worker_nodes *nodes, struct farm *farm, struct worker_slot *slots,
                       const struct node_handlers *handlers)
{
    const struct pool_table *pools = &farm->options->pools;
    size_t count = 0;

    for (size_t i = 0; i < pools->count; i++)
        count += pools->pools[i].node_count;
    *nodes = (struct worker_nodes){
        .farm = farm, .looks.loop = farm->loop, .nodes = xcalloc(count + 1, sizeof(struct node *))};
    for (size_t i = 0; i < pools->count; i++) {
        add_nodes(nodes, &pools->pools[i], slots, handlers);
        if (pools->pools[i].launcher == POOL_SLURM) add_site(nodes, &pools->pools[i], slots);
        for (int k = pool_options_worker_count(&pools->pools[i]); k > 0; k--)
            (slots++)->seat.kind = (int)i + 1; // as in daemon/farm/pool_access.h
    }
}

// Frames that the site could begin to render now; no more than `enough` are counted.
static void count_waiting(struct farm *farm, const struct worker_site *site, int64_t enough, struct slurm_need *need)
{
    const struct turns_seat nobody = {.kind = site->slots[0].seat.kind};
    double stay_s = slurm_pool_stay_s(site->slurm);

    if (farm->drain.user || !queue_choose_job(farm->queue, &nobody)) return;
    for (const struct queue_job *job = queue_first_job(farm->queue); job && need->tasks < enough; job = job->next) {
        double frame_s;

        if (job->is_paused || job->block != QUEUE_OPEN || !queue_job_is_live(job)) continue;
        if (job->states.counts[FRAME_QUEUED] == 0 || !turns_may_serve(&nobody, &job->turn)) continue;
        frame_s = estimate_median_s(&job_table_find(&farm->jobs, job->id)->estimate);
        if (stay_s > 0 && frame_s > stay_s)
            need->too_long_s = frame_s;
        else
            need->tasks += job->states.counts[FRAME_QUEUED];
    }
}

// Returns the number of the node's workers with frames in hand.
static int check_node(struct worker_site *site, int node, int64_t now_ms)
{
    struct worker_slot *slots = site->slots + (ptrdiff_t)node * site->worker_count;
    int busy = 0;
    bool is_short = false;

    for (int i = 0; i < site->worker_count; i++) {
        busy += slots[i].worker && slots[i].worker->in_flight.count > 0;
        slots[i].is_short = slots[i].is_short && slots[i].worker;
        is_short = is_short || slots[i].is_short;
    }
    if (busy > 0)
        slurm_pool_note_busy(site->slurm, node, now_ms);
    else if (is_short)
        slurm_pool_note_short(site->slurm, node);
    return busy;
}

static void check_site(struct farm *farm, struct worker_site *site, int64_t now_ms)
{
    struct slurm_need need = {0};
    int64_t busy = 0;

    for (int node = 0; node < site->slot_count / site->worker_count; node++)
        busy += check_node(site, node, now_ms);
    count_waiting(farm, site, site->slot_count, &need);
    need.tasks += busy;
    slurm_pool_check(site->slurm, &need, now_ms);
}

void worker_nodes_check(struct worker_nodes *nodes, int64_t now_ms)
{
    for (size_t i = 0; i < nodes->site_count; i++)
        if (nodes->is_stopping)
            slurm_pool_keep(nodes->sites[i].slurm, now_ms);
        else
            check_site(nodes->farm, &nodes->sites[i], now_ms);
    for (size_t i = 0; i < nodes->count; i++)
        node_check(nodes->nodes[i], now_ms);
    if (nodes->has_skipped) farm_want_feed(nodes->farm);
    nodes->has_skipped = false;
}

bool worker_nodes_are_behind(struct worker_nodes *nodes, const struct worker_slot *slot)
{
    bool is_behind = slot->node && node_is_behind(slot->node);

    if (is_behind) nodes->has_skipped = true;
    return is_behind;
}

void worker_nodes_stop(struct worker_nodes *nodes)
{
    for (size_t i = 0; i < nodes->site_count; i++)
        slurm_pool_stop(nodes->sites[i].slurm);
    for (size_t i = 0; i < nodes->count; i++)
        node_stop(nodes->nodes[i]);
}

void worker_nodes_finish(struct worker_nodes *nodes)
{
    for (size_t i = 0; i < nodes->site_count; i++)
        slurm_pool_destroy(nodes->sites[i].slurm);
    for (size_t i = 0; i < nodes->count; i++)
        node_destroy(nodes->nodes[i]);
    free(nodes->sites);
    free(nodes->nodes);
    *nodes = (struct worker_nodes){0};
}

bool worker_nodes_are_ready(const struct worker_slot *slot)
{
    return !slot->node || node_state(slot->node) == NODE_READY;
}

double worker_nodes_left_s(const struct worker_slot *slot, int64_t now_ms)
{
    const struct node_stay *stay = slot->node ? node_stay(slot->node) : NULL;

    return stay && stay->end_ms > 0 ? (double)(stay->end_ms - now_ms) / 1000 : HUGE_VAL;
}

void worker_nodes_note_short(struct worker_slot *slot, double frame_s)
{
    // One that no machine stays for is no reason to take another.
    slot->is_short = frame_s * 1000 <= (double)node_stay(slot->node)->whole_ms;
}

void worker_nodes_set_params(const struct node *node, struct worker_child_params *params)
{
    const struct pool_options *pool = node_pool(node);

    if (pool->backend) params->backend = pool->backend;
    if (pool->thread_count) params->thread_count = pool->thread_count;
}
