// The HTTP server: connections, their limits and times, and which route answers a request.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "web/http/http_request.h"
#include "web/http/http_socket.h"

#include <stdbool.h>
#include <stddef.h>
#include <uv.h>

struct error;
struct http_origins;
struct http_server;

struct http_server_params {
    uv_loop_t *loop; // these are borrowed and outlive us
    const char *address;
    const struct http_origins *origins;
    const struct http_route *routes; // the first that fits answers; ends where `path` is NULL
    const struct http_socket_handlers *sockets;
    void *sockets_user;
    size_t connection_limit; // of all
    size_t address_limit;    // of one place (see http_peer.h)
    size_t buffer_bytes;     // of bodies and answers that wait (see http_budget.h)
    uint64_t send_time_ms;   // for an answer to leave, and for a WebSocket that is full
};

struct http_server *http_server_open(const struct http_server_params *params, struct error *error);
int http_server_port(const struct http_server *server);
// Ends all connections, and calls `on_closed` when none is left; the loop then runs out of what the server has in it.
void http_server_close(struct http_server *server, void (*on_closed)(void *user), void *user);
// Frees a closed server after the loop has ended: libwebsockets asks for that where the loop is not its own. NULL:
// none.
void http_server_destroy(struct http_server *server);
