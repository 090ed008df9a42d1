// A launcher at work: the program (ssh, srun, ...) that starts a node and carries its stream.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

#include <uv.h>

struct error;
struct node_launch;

enum { NODE_LAUNCH_TEXT_SIZE = 512 };

struct node_launch_fds {
    int in, out; // what the node says, what is said to it; the caller's
};

// Called for each line that the launcher, or the node through it, writes to standard error.
typedef void node_launch_on_text(void *user, const char *line);

// `command` ends in NULL; its program is searched in PATH. NULL on failure, with the cause.
struct node_launch *node_launch_start(uv_loop_t *loop, char *const command[], node_launch_on_text *on_text, void *user,
                                      struct node_launch_fds *fds, struct error *error);
// The last line that it has written to standard error; "": there is none.
const char *node_launch_last_text(struct node_launch *launch);
// How it ended, for people: an exit status tells nothing for sure. NULL while it runs.
const char *node_launch_format_end(struct node_launch *launch);
// Ends the launcher, by SIGTERM and then by SIGKILL. It frees itself; `on_text` is not called any more.
void node_launch_end(struct node_launch *launch);
