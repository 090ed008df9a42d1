// A node: a machine whose workers are started through a launcher, as the daemon sees it.
// SPDX-License-Identifier: Apache-2.0
//
// The launcher carries a stream of lines (node/node_line.h). Its end, or a time without a line, is the end of the node:
// all its workers are gone then. How the launcher exits says nothing.
#pragma once

#include "daemon/nodes/worker_link.h"

#include <stdbool.h>
#include <stdint.h>

#include <uv.h>

struct error;
struct node;
struct node_probe;
struct pool_options;

enum node_state {
    NODE_DOWN,     // nothing runs
    NODE_STARTING, // the launcher runs, the node has not answered
    NODE_PROBING,  // it has answered; whether it sees the roots is looked at
    NODE_READY     // it takes workers
};

struct node_params {
    const struct pool_options *pool; // borrowed; outlives the node
    const char *name;                // borrowed; outlives the node
    const char *version;             // borrowed; outlives the node; which a node must have
    struct node_looks *looks;        // borrowed; outlives the node
    const char *launch_socket;       // borrowed; outlives the node; as of node_launch.h
    int worker_count;
};

struct node_handlers {
    void (*on_change)(void *user, struct node *node);         // its state or its reason changed
    void (*list_roots)(void *user, struct node_probe *probe); // adds the roots that the node must see
};

// `handlers` is borrowed and outlives the node.
struct node *node_create(uv_loop_t *loop, const struct node_params *params, const struct node_handlers *handlers,
                         void *user);
void node_destroy(struct node *node); // legal when it is down; accepts NULL
// To be called several times a second: starts it when that is due, beats, and looks whether it was heard.
void node_check(struct node *node, int64_t now_ms);
// Ends it with all its workers, whose handlers are told. It is not started any more.
void node_stop(struct node *node);
// Whether much waits that it has not read yet.
bool node_is_behind(const struct node *node);
// Probes a ready node again, for its roots may have changed: it goes on meanwhile, and ends if something is wrong.
void node_look_at_roots(struct node *node);

// A machine that comes and goes: its node is not started, and ended if it was, until node_allow; why stands as its
// reason. Nodes of Slurm are held from the start. `is_dismissed`: its end is wanted, and no fault.
void node_hold(struct node *node, const char *reason, bool is_dismissed);
// It may be started from now on, by the pool's command "step" with `place`. `name` is the machine's. Both are copied.
// Does nothing while it is allowed.
void node_allow(struct node *node, const char *name, const char *place);
// For how long its machine is there. The zero value: it stays.
struct node_stay {
    int64_t end_ms;   // monotonic, as of node_check; when it goes; 0: never
    int64_t whole_ms; // from its coming on
};

void node_set_stay(struct node *node, const struct node_stay *stay);
const struct node_stay *node_stay(const struct node *node);

enum node_state node_state(const struct node *node);
const char *node_name(const struct node *node);
const struct pool_options *node_pool(const struct node *node);
const char *node_host(const struct node *node);   // what it calls itself; NULL: unknown
const char *node_reason(const struct node *node); // why it is not ready; NULL: it is

// A worker of a ready node with the given number, which none of its running workers has. `reason` of on_end is set when
// the node, not the worker, ended.
void node_start_worker(struct node *node, int number, struct worker_link *link,
                       const struct worker_child_params *params, const struct worker_child_handlers *handlers,
                       void *user);
