// A launcher at work: the program (ssh, srun, ...) that starts a node and carries its stream.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include <uv.h>

struct error;
struct node_launch;
struct pool_options;

enum { NODE_LAUNCH_TEXT_SIZE = 512 };

struct node_launch_fds {
    int in, out; // what the node says, what is said to it; the caller's
};

// Called for each line that the launcher, or the node through it, writes to standard error.
typedef void node_launch_on_text(void *user, const char *line);

struct node_launch_order {
    const char *socket; // march-launch's, which starts the launcher in a unit of its own; NULL: the daemon starts it
    const struct pool_options *pool;
    const char *const *words; // which of the pool's commands, as of settings/pool_command.h
};

// `order` is borrowed during the call. NULL on failure, with the cause. What march-launch refuses comes as text, like
// the launcher's own.
struct node_launch *node_launch_start(uv_loop_t *loop, const struct node_launch_order *order,
                                      node_launch_on_text *on_text, void *user, struct node_launch_fds *fds,
                                      struct error *error);
// The last line that it has written to standard error; "": there is none.
const char *node_launch_last_text(struct node_launch *launch);
// How it ended, for people: an exit status tells nothing for sure. NULL while it runs.
const char *node_launch_format_end(struct node_launch *launch);
// Whether it ended with exit status 0.
bool node_launch_has_succeeded(const struct node_launch *launch);
// Ends the launcher, by SIGTERM and then by SIGKILL. It frees itself; `on_text` is not called any more.
void node_launch_end(struct node_launch *launch);
