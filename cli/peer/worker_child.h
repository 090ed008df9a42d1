// A march-worker as a child process, connected by a socket pair.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/exit_status.h"

#include <stdbool.h>
#include <sys/types.h>

struct connection;
struct error;
struct interrupt;
struct message;
struct options;

// The zero value is no child.
struct worker_child {
    pid_t pid;
    struct connection *connection; // owned
};

// Starts the program of --worker-program, else $MARCH_WORKER, else the march-worker beside this binary. The child
// inherits stderr and dies with its parent.
bool worker_child_start(struct worker_child *child, const struct options *options, struct interrupt *interrupt,
                        struct error *error);
// Waits a few seconds for the child to end, then kills it; or kills it at once. Accepts the zero value.
void worker_child_stop(struct worker_child *child, bool at_once);
// When the connection broke because the child ended, replaces `error` by how it ended. Call it after CONNECTION_CLOSED.
void worker_child_explain_end(struct worker_child *child, struct error *error);

// Starts a worker without GL.
bool worker_child_start_without_gl(struct worker_child *child, const struct options *options,
                                   struct interrupt *interrupt, struct error *error);
// As connection_call; when the child ends instead of answering, `error` says how.
enum exit_status worker_child_call(struct worker_child *child, const char *method, const char *params,
                                   struct message *reply, struct error *error);

struct worker_question {
    const char *method, *params; // as for connection_call
    bool needs_gl;               // else the worker makes no context
    const char *label;           // shown on stderr, with parts done and time, while a call takes long; NULL: nothing is
};

// Starts a worker for one request and stops it; `reply` as for connection_call.
enum exit_status worker_child_ask(const struct options *options, const struct worker_question *question,
                                  struct message *reply, struct error *error);
