// A step of a probe on a thread, for file systems answer when they like.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "node/node_probe.h"

#include <uv.h>

struct error;
struct node_look;

// Looks of one program: two at a time, so that folders that do not answer leave threads to others. The zero value has
// none, and a loop that is the caller's.
struct node_looks {
    uv_loop_t *loop;
    int running;
    struct node_look *first; // of those that wait
};

enum node_look_step {
    NODE_LOOK_DAEMON_WRITES, // of its roots, input roots that this machine lacks are left out
    NODE_LOOK_NODE_ANSWERS,  // looks at the daemon's files, then writes
    NODE_LOOK_DAEMON_LOOKS,  // at the node's files, then removes all
    NODE_LOOK_REMOVES        // all files, of a probe that went wrong
};

// Called on the loop. `probe` is the callee's again; an empty error: all is well.
typedef void node_look_on_done(void *user, struct node_probe *probe, const struct error *error);

// Takes the probe over, which is empty afterwards. `looks` is borrowed until the end.
struct node_look *node_look_start(struct node_looks *looks, struct node_probe *probe, enum node_look_step step,
                                  node_look_on_done *on_done, void *user);
// Nobody waits for it any more: it frees itself. Accepts NULL.
void node_look_abandon(struct node_look *look);
