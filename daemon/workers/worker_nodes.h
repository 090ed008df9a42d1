// The nodes of the settings' pools, and the slots of their workers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/nodes/node.h"
#include "node/node_look.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct farm;
struct node_probe;
struct options;
struct slurm_pool;
struct worker_child_params;
struct worker_slot;

// A pool of Slurm's.
struct worker_site {
    struct slurm_pool *slurm;  // owned
    struct worker_slot *slots; // borrowed; outlive us; of its nodes in order, each with as many workers
    int slot_count, worker_count;
};

// The zero value is empty.
struct worker_nodes {
    struct farm *farm;   // borrowed; outlives us
    struct node **nodes; // owned
    size_t count;
    struct worker_site *sites; // owned
    size_t site_count;
    struct node_looks looks;
    bool is_stopping; // the machines stay as they are
    bool has_skipped; // a worker whose node was behind: frames are offered again
};

int worker_nodes_count_slots(const struct options *options);
// Adds the roots that a node must see: the output roots that are there, and the input roots that this machine has.
void worker_nodes_list_roots(void *farm, struct node_probe *probe);
// Makes the nodes and gives each its slots, of those at `slots`, which are as many as counted. None is started. The
// handlers' user is the farm.
void worker_nodes_make(struct worker_nodes *nodes, struct farm *farm, struct worker_slot *slots,
                       const struct node_handlers *handlers);
void worker_nodes_check(struct worker_nodes *nodes, int64_t now_ms); // as node_check and slurm_pool_check
void worker_nodes_stop(struct worker_nodes *nodes);
void worker_nodes_finish(struct worker_nodes *nodes); // legal when they are stopped

// Whether a worker may be started in the slot as far as its node is concerned.
bool worker_nodes_are_ready(const struct worker_slot *slot);
// Whether the slot's worker gets no frames for now, since its node has not read what waits for it.
bool worker_nodes_are_behind(struct worker_nodes *nodes, const struct worker_slot *slot);
// Seconds until the machine of the slot goes; infinite: it stays.
double worker_nodes_left_s(const struct worker_slot *slot, int64_t now_ms);
// A frame that takes so long was not given to the slot, for it would not be done before.
void worker_nodes_note_short(struct worker_slot *slot, double frame_s);
// What the node's pool says goes before what holds for this machine.
void worker_nodes_set_params(const struct node *node, struct worker_child_params *params);
