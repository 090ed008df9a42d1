// A march-worker of our own, at the other end of a socket pair.
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

// Starts the program of --worker-program, else $MARCH_WORKER, else the march-worker beside this binary. Its stderr is ours;
// it dies with us.
bool worker_child_start(struct worker_child *child, const struct options *options, struct interrupt *interrupt,
                        struct error *error);
// Lets it end by itself, for a few seconds at most, or kills it at once. Accepts the zero value.
void worker_child_stop(struct worker_child *child, bool at_once);
// Replaces `error` by how the child ended when its end is why the connection broke. Call it after CONNECTION_CLOSED.
void worker_child_explain_end(struct worker_child *child, struct error *error);

// One that needs no GL.
bool worker_child_start_without_gl(struct worker_child *child, const struct options *options,
                                   struct interrupt *interrupt, struct error *error);
// A request to it, as connection_call has it; how the child ended is told where that is why there is no answer.
enum exit_status worker_child_call(struct worker_child *child, const char *method, const char *params,
                                   struct message *reply, struct error *error);

struct worker_question {
    const char *method, *params; // as connection_call has them
    bool needs_gl;               // else the worker makes no context
    const char *label;           // shown on a terminal, with the time gone by, while the answer takes long; may be NULL
};

// One request to a worker started for it and stopped after it; `reply` is as connection_call has it.
enum exit_status worker_child_ask(const struct options *options, const struct worker_question *question,
                                  struct message *reply, struct error *error);
