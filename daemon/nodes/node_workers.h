// The workers of one node, by their numbers: starts them, hands on what they say, and their end with the node.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/nodes/worker_link.h"

#include <stdbool.h>

struct error;
struct node_line;
struct node_pipe;
struct node_worker;

// The zero value has none.
struct node_workers {
    struct node_worker *first; // each is owned by its link
    struct node_pipe *pipe;    // borrowed; NULL: the node is gone, and what is said to its workers is lost
};

// As node_start_worker.
void node_workers_start(struct node_workers *workers, int number, struct worker_link *link,
                        const struct worker_child_params *params, const struct worker_child_handlers *handlers,
                        void *user);
// A line about a worker.
bool node_workers_take_line(struct node_workers *workers, const struct node_line *line, struct error *error);
// All have ended with their node: their handlers are told, and close them.
void node_workers_lose(struct node_workers *workers, const char *reason);
