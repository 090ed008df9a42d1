// The connections that are open: how many there may be, and which one makes room for a new one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct http_connection;

struct http_connections {
    struct http_connection *first;
    size_t limit, place_limit; // of all, and of one place (see http_peer.h)
};

// True where one more from `place` may come. Where a limit is reached, one that waits for its client is killed for it:
// first the one that has been silent for longest, without a request; else the oldest whose client the farm does not
// know, and which has not sent its body or takes its answer. False: there is none, or too many are being killed.
bool http_connections_make_room(struct http_connections *connections, const char *place);
void http_connections_add(struct http_connections *connections, struct http_connection *connection);
void http_connections_remove(struct http_connections *connections, struct http_connection *connection);
