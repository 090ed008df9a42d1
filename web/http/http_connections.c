// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_connections.h"

#include "core/base/log.h"
#include "web/http/http_connection.h"

#include <string.h>

enum { LEAVING_LIMIT = HTTP_SPARE_CONNECTIONS / 2 }; // killed, but still there

// How well one can do without it.
enum worth { SILENT, UNKNOWN, NEEDED };

static enum worth worth_of(const struct http_connection *connection)
{
    const struct http_request *request = connection->request;

    if (connection->socket || connection->is_leaving) return NEEDED;
    if (!request) return SILENT;
    return !connection->is_known && (!request->has_all || request->is_answered) ? UNKNOWN : NEEDED;
}

// `place` NULL: any. NULL: there is none.
static struct http_connection *find_victim(const struct http_connections *connections, const char *place)
{
    struct http_connection *victim = NULL;
    enum worth least = NEEDED;

    for (struct http_connection *at = connections->first; at; at = at->next) {
        enum worth worth = worth_of(at);

        if (worth == NEEDED || (place && strcmp(at->peer.place, place) != 0)) continue;
        if (worth > least || (worth == least && at->since_ms > victim->since_ms)) continue;
        victim = at;
        least = worth;
    }
    return victim;
}

bool http_connections_make_room(struct http_connections *connections, const char *place)
{
    size_t count = 0, place_count = 0, leaving = 0;
    struct http_connection *victim;

    for (const struct http_connection *at = connections->first; at; at = at->next) {
        leaving += at->is_leaving;
        count += !at->is_leaving;
        place_count += !at->is_leaving && strcmp(at->peer.place, place) == 0;
    }
    if (leaving >= LEAVING_LIMIT) return false;
    if (count < connections->limit && place_count < connections->place_limit) return true;
    victim = find_victim(connections, place_count >= connections->place_limit ? place : NULL);
    if (!victim) return false;
    log_debug("%s: a connection makes room for one of %s", victim->peer.address, place);
    http_connection_kill(victim);
    return true;
}

void http_connections_add(struct http_connections *connections, struct http_connection *connection)
{
    connection->next = connections->first;
    if (connections->first) connections->first->previous = connection;
    connections->first = connection;
}

void http_connections_remove(struct http_connections *connections, struct http_connection *connection)
{
    if (connection->previous)
        connection->previous->next = connection->next;
    else
        connections->first = connection->next;
    if (connection->next) connection->next->previous = connection->previous;
}
