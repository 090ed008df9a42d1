// The unix socket, created here or inherited from systemd, and the clients that are connected to it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/clients/client.h"

#include <stdbool.h>

struct error;
struct listener;

// Borrowed while the listener lives, but for the handlers.
struct listener_params {
    const char *path;
    struct loop_turns *turns;
    struct work_desk *desk;
    struct memory_return *memory;
    const struct rights *rights; // who is the web user
    // As in struct client_host.
    void (*on_message)(void *user, struct client *client, struct message *message);
    void (*on_gone)(void *user, struct client *client); // nothing may be sent to it
    void *user;
};

// Listens at `path` with mode 0660, or on the socket inherited from systemd. A stale socket is replaced; a daemon that
// answers there is an error. NULL on failure. While the program may open no more files, connections wait.
struct listener *listener_open(uv_loop_t *loop, const struct listener_params *params, struct error *error);
void listener_stop(struct listener *listener); // accepts no connections and removes the socket; connected clients stay
void listener_stop_reading(struct listener *listener); // no more messages are read; answers still go out
// Closes the clients too. The listener frees itself when all handles are closed.
void listener_close(struct listener *listener);
