// SPDX-License-Identifier: Apache-2.0
#include "daemon/workers/worker_nodes.h"

#include "core/base/alloc.h"
#include "daemon/farm/farm.h"
#include "daemon/settings/options.h"
#include "daemon/settings/pool_options.h"
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

void worker_nodes_make(struct worker_nodes *nodes, struct farm *farm, struct worker_slot *slots,
                       const struct node_handlers *handlers)
{
    const struct options *options = farm->options;

    for (size_t i = 0; i < options->pools.count; i++) {
        const struct pool_options *pool = &options->pools.pools[i];

        nodes->nodes = xrealloc(nodes->nodes, (nodes->count + pool->node_count) * sizeof(struct node *));
        for (size_t k = 0; k < pool->node_count; k++) {
            const struct node_params params = {.pool = pool,
                                               .name = pool->nodes[k].name,
                                               .version = options->version,
                                               .launch_socket = options->launch_socket,
                                               .worker_count = pool->nodes[k].worker_count};
            struct node *node = node_create(farm->loop, &params, handlers, farm);

            nodes->nodes[nodes->count++] = node;
            for (int worker = 0; worker < params.worker_count; worker++, slots++) {
                slots->node = node;
                slots->seat.kind = (int)i + 1; // as in daemon/farm/pool_access.h
            }
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
