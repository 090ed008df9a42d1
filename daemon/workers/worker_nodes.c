// SPDX-License-Identifier: Apache-2.0
#include "daemon/workers/worker_nodes.h"

#include "core/base/alloc.h"
#include "daemon/settings/options.h"
#include "daemon/settings/pool_options.h"
#include "daemon/workers/worker_slot.h"

#include <stdlib.h>

int worker_nodes_count_slots(const struct options *options)
{
    int count = 0;

    for (size_t i = 0; i < options->pools.count; i++)
        count += pool_options_worker_count(&options->pools.pools[i]);
    return count;
}

void worker_nodes_make(struct worker_nodes *nodes, uv_loop_t *loop, const struct options *options,
                       struct worker_slot *slots, node_on_change *on_change, void *user)
{
    for (size_t i = 0; i < options->pools.count; i++) {
        const struct pool_options *pool = &options->pools.pools[i];

        nodes->nodes = xrealloc(nodes->nodes, (nodes->count + pool->node_count) * sizeof(struct node *));
        for (size_t k = 0; k < pool->node_count; k++) {
            const struct node_params params = {.pool = pool,
                                               .name = pool->nodes[k].name,
                                               .version = options->version,
                                               .worker_count = pool->nodes[k].worker_count};
            struct node *node = node_create(loop, &params, on_change, user);

            nodes->nodes[nodes->count++] = node;
            for (int worker = 0; worker < params.worker_count; worker++)
                (slots++)->node = node;
        }
    }
}

void worker_nodes_check(struct worker_nodes *nodes, int64_t now_ms)
{
    for (size_t i = 0; i < nodes->count; i++)
        node_check(nodes->nodes[i], now_ms);
}

void worker_nodes_stop(struct worker_nodes *nodes)
{
    for (size_t i = 0; i < nodes->count; i++)
        node_stop(nodes->nodes[i]);
}

void worker_nodes_finish(struct worker_nodes *nodes)
{
    for (size_t i = 0; i < nodes->count; i++)
        node_destroy(nodes->nodes[i]);
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
