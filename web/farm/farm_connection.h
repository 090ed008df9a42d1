// A connection to the daemon that has the rights of one token, and never those of this program.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <uv.h>

struct farm_connection;

// Whose token it is. Borrowed; lives as long as the connection.
struct farm_identity {
    char *user, *scope;
    char *session; // a new token in place of a one-time one, or NULL
    bool has_expiry;
    double expires; // unix s
};

enum farm_end {
    FARM_OPEN,    // it has not ended
    FARM_AWAY,    // the daemon is not there, has closed the connection, or does not answer
    FARM_REFUSED, // the token is not valid
    FARM_FAULT    // the daemon did not answer as docs/protocol.md says, or is too old to know tokens
};

struct farm_connection_handlers {
    void (*on_ready)(void *user, const struct farm_identity *identity); // from here on messages are taken
    void (*on_line)(void *user, const char *line, size_t length);       // borrowed, without its line feed
    void (*on_drained)(void *user);                                     // what waits to be sent is little again
    void (*on_closed)(void *user, enum farm_end end, const char *why);  // the connection is gone afterwards
};

struct farm_connection_params {
    uv_loop_t *loop;         // these are borrowed and outlive us
    const char *socket_path; // the daemon's
    const char *token;       // copied; NULL: nobody's, which shows only that the daemon answers
    const struct farm_connection_handlers *handlers;
    void *user;
};

// Never NULL; no handler is called from within. The token is given up for first, `auth.drop`, then `auth.token`.
struct farm_connection *farm_connection_open(const struct farm_connection_params *params);
void farm_connection_set_user(struct farm_connection *connection, void *user);
const struct farm_identity *farm_connection_identity(const struct farm_connection *connection);
// One message. Line feeds within become spaces, for a line is a message. Legal once it is ready.
void farm_connection_send(struct farm_connection *connection, const char *text, size_t length);
size_t farm_connection_waiting(const struct farm_connection *connection);       // bytes that wait to be sent
bool farm_connection_is_full(const struct farm_connection *connection);         // on_drained follows
void farm_connection_pause(struct farm_connection *connection, bool is_paused); // stops and starts to read
// No handler is called from here on; accepts NULL.
void farm_connection_close(struct farm_connection *connection);
