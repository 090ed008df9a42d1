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
        if (access(inputs->paths[i], F_OK) == 0) node_probe_add(probe, inputs->paths[i], "");
}

static void add_nodes(struct worker_nodes *nodes, const struct pool_options *pool, struct worker_slot *slots,
                      const struct node_handlers *handlers)
{
    for (size_t k = 0; k < pool->node_count; k++) {
        const struct node_params params = {.pool = pool,
                                           .name = pool->nodes[k].name,
                                           .version = nodes->farm->options->version,
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
    *nodes = (struct worker_nodes){.farm = farm, .nodes = xcalloc(count + 1, sizeof(struct node *))};
    for (size_t i = 0; i < pools->count; i++) {
        add_nodes(nodes, &pools->pools[i], slots, handlers);
        if (pools->pools[i].launcher == POOL_SLURM) add_site(nodes, &pools->pools[i], slots);
        for (int k = pool_options_worker_count(&pools->pools[i]); k > 0; k--)
            (slots++)->seat.kind = (int)i + 1; // as in daemon/farm/pool_access.h
    }
}

// Frames that a worker of the seat could begin to render now; no more than `enough` are counted.
static int64_t count_waiting(const struct farm *farm, const struct turns_seat *seat, int64_t enough)
{
    const struct turns_seat nobody = {.kind = seat->kind};
    int64_t count = 0;

    if (farm->drain.user || !queue_choose_job(farm->queue, &nobody)) return 0;
    for (const struct queue_job *job = queue_first_job(farm->queue); job && count < enough; job = job->next)
        if (!job->is_paused && job->block == QUEUE_OPEN && queue_job_is_live(job) && turns_may_serve(seat, &job->turn))
            count += job->states.counts[FRAME_QUEUED];
    return count;
}

static void check_site(const struct farm *farm, struct worker_site *site, int64_t now_ms)
{
    int64_t busy = 0;

    for (int i = 0; i < site->slot_count; i++) {
        const struct worker_process *worker = site->slots[i].worker;

        if (!worker || worker->in_flight.count == 0) continue;
        slurm_pool_note_busy(site->slurm, i / site->worker_count, now_ms);
        busy++;
    }
    slurm_pool_check(site->slurm, busy + count_waiting(farm, &site->slots[0].seat, site->slot_count), now_ms);
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

void worker_nodes_set_params(const struct node *node, struct worker_child_params *params)
{
    const struct pool_options *pool = node_pool(node);

    if (pool->backend) params->backend = pool->backend;
    if (pool->thread_count) params->thread_count = pool->thread_count;
}
