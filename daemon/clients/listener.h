// The unix socket: made or taken from systemd, and the clients that are connected to it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/clients/client.h"

#include <stdbool.h>

struct error;
struct listener;

struct listener_handlers {
    void (*on_message)(void *user, struct client *client, const struct message *message);
    void (*on_gone)(void *user, struct client *client); // nothing may be sent to it any more
    void *user;
};

// Listens at `path` with mode 0660, or on the socket systemd handed over. What is left of a daemon that no longer
// answers is replaced; one that answers is an error. NULL on failure.
struct listener *listener_open(uv_loop_t *loop, const char *path, const struct listener_handlers *handlers,
                               struct error *error);
void listener_stop(struct listener *listener); // accepts no more and removes the socket; who is connected stays
void listener_stop_reading(
    struct listener *listener); // nobody who is connected is heard any more; what is sent still goes out
// Closes the clients too. The listener frees itself when all is closed.
void listener_close(struct listener *listener);
