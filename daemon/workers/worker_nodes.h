// The nodes of the settings' pools, and the slots of their workers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/nodes/node.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <uv.h>

struct options;
struct worker_child_params;
struct worker_slot;

// The zero value is empty.
struct worker_nodes {
    struct node **nodes; // owned
    size_t count;
};

int worker_nodes_count_slots(const struct options *options);
// Makes the nodes and gives each its slots, of those at `slots`, which are as many as counted. None is started.
void worker_nodes_make(struct worker_nodes *nodes, uv_loop_t *loop, const struct options *options,
                       struct worker_slot *slots, node_on_change *on_change, void *user);
void worker_nodes_check(struct worker_nodes *nodes, int64_t now_ms); // as node_check
void worker_nodes_stop(struct worker_nodes *nodes);
void worker_nodes_finish(struct worker_nodes *nodes); // legal when they are stopped

// Whether a worker may be started in the slot as far as its node is concerned.
bool worker_nodes_are_ready(const struct worker_slot *slot);
// What the node's pool says goes before what holds for this machine.
void worker_nodes_set_params(const struct node *node, struct worker_child_params *params);
