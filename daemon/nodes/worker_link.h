// The way to one worker: a child of the daemon, or a worker of a node. What it says comes to worker_child_handlers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "node/worker_child.h"

#include <stdbool.h>
#include <stddef.h>

struct error;

struct worker_link_calls; // how it is done

struct worker_link {
    const struct worker_link_calls *calls;
    void *self; // owned
};

// As the functions of worker_child.h.
struct worker_link_calls {
    int (*pid)(const void *self);
    void (*send)(void *self, const char *bytes, size_t count);
    void (*kill)(void *self);
    const char *(*check)(void *self);
    void (*read_log)(void *self);
    void (*close)(void *self);
};

// A worker on this machine.
bool worker_link_start_here(struct worker_link *link, uv_loop_t *loop, const struct worker_child_params *params,
                            const struct worker_child_handlers *handlers, void *user, struct error *error);
