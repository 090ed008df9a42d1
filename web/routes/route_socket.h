// GET /ws: a WebSocket and its own connection to the daemon, message by message.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "web/http/http_socket.h"

#include <uv.h>

// Borrowed.
struct route_socket {
    uv_loop_t *loop;
    const char *socket_path; // the daemon's
};

extern const struct http_socket_handlers route_socket_handlers; // their user is a struct route_socket
