// SPDX-License-Identifier: Apache-2.0
#include "web/routes/route_socket.h"

#include "core/base/alloc.h"
#include "core/base/log.h"
#include "web/farm/farm_connection.h"

#include <stdlib.h>

// A page's WebSocket and its connection. What one side does not take, the other is not read for.
struct bridge {
    struct http_socket *socket;
    struct farm_connection *connection; // NULL: it has ended
    bool is_ready;
};

static void on_ready(void *user, const struct farm_identity *identity);
static void on_line(void *user, const char *line, size_t length);
static void on_connection_drained(void *user);
static void on_connection_closed(void *user, enum farm_end end, const char *why);

static const struct farm_connection_handlers handlers = {on_ready, on_line, on_connection_drained,
                                                         on_connection_closed};

static void *on_open(void *user, struct http_socket *socket, const char *token)
{
    const struct route_socket *route = user;
    struct bridge *bridge = xcalloc(1, sizeof *bridge);
    struct farm_connection_params params = {
        .loop = route->loop, .socket_path = route->socket_path, .token = token, .handlers = &handlers, .user = bridge};

    bridge->socket = socket;
    bridge->connection = farm_connection_open(&params);
    http_socket_pause(socket, true); // until the daemon has taken the token
    return bridge;
}

static void on_ready(void *user, const struct farm_identity *identity)
{
    struct bridge *bridge = user;

    bridge->is_ready = true;
    http_socket_set_user(bridge->socket, identity->user);
    http_socket_pause(bridge->socket, false);
}

static void on_message(void *link, char *text, size_t length)
{
    struct bridge *bridge = link;

    if (!bridge->connection || !bridge->is_ready) return;
    farm_connection_send(bridge->connection, text, length);
    http_socket_set_beside(bridge->socket, farm_connection_waiting(bridge->connection));
    if (farm_connection_is_full(bridge->connection)) http_socket_pause(bridge->socket, true);
}

static void on_connection_drained(void *user)
{
    struct bridge *bridge = user;

    http_socket_set_beside(bridge->socket, farm_connection_waiting(bridge->connection));
    http_socket_pause(bridge->socket, false);
}

static void on_line(void *user, const char *line, size_t length)
{
    struct bridge *bridge = user;

    http_socket_set_beside(bridge->socket, farm_connection_waiting(bridge->connection));
    http_socket_send(bridge->socket, line, length);
    if (http_socket_is_full(bridge->socket)) farm_connection_pause(bridge->connection, true);
}

static void on_socket_drained(void *link)
{
    struct bridge *bridge = link;

    if (bridge->connection) farm_connection_pause(bridge->connection, false);
}

static void on_connection_closed(void *user, enum farm_end end, const char *why)
{
    struct bridge *bridge = user;

    bridge->connection = NULL;
    log_debug("a WebSocket ends: the daemon: %s", why);
    http_socket_pause(bridge->socket, false); // its answer to the close is read
    if (end == FARM_REFUSED)
        http_socket_close(bridge->socket, HTTP_SOCKET_POLICY, "the token is not valid");
    else
        http_socket_close(bridge->socket, HTTP_SOCKET_TRY_LATER, "the daemon is away");
}

static void on_socket_closed(void *link)
{
    struct bridge *bridge = link;

    farm_connection_close(bridge->connection);
    free(bridge);
}

const struct http_socket_handlers route_socket_handlers = {on_open, on_message, on_socket_drained, on_socket_closed};
