// What the files of this room share about one connection of a client.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "web/http/http_budget.h"
#include "web/http/http_peer.h"

#include <libwebsockets.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct http_known;
struct http_route;
struct http_server;
struct http_socket;

enum {
    HTTP_SMALL_SIZE = 4096,       // bytes of a body or an answer that are not counted
    HTTP_QUERY_LIMIT = 16,        // NAME=VALUE of one address
    HTTP_HEAD_LIMIT = 8 * 1024,   // bytes of a request's line and headers
    HTTP_HEAD_TIME_MS = 30000,    // for a request's line and headers, after the connection or the last answer
    HTTP_BODY_TIME_MS = 60000,    // for a request's body
    HTTP_ANSWER_TIME_MS = 600000, // for the daemon's answer
    HTTP_WRITE_TIME_MS = 30000,   // for each part of an answer to leave
    HTTP_SPARE_CONNECTIONS = 256  // above the limit, for those that are being killed
};

struct http_connection {
    struct http_server *server;   // borrowed; outlives us
    struct lws *wsi;              // borrowed; its user's pointer is this
    struct http_request *request; // owned; NULL: none is worked on
    struct http_socket *socket;   // owned; NULL: no WebSocket
    uint64_t deadline_ms;         // of the loop's clock; 0: none
    uint64_t since_ms;            // of the loop's clock: its request began, or its last one ended
    uint64_t end_ms;              // likewise: no deadline is later; 0: any
    struct http_hold hold;        // what its request or WebSocket has in memory
    struct http_peer peer;
    bool is_known;                           // the farm has taken the token of its request or WebSocket
    bool is_leaving;                         // it is being killed
    struct http_connection *previous, *next; // on the server's list
};

struct http_request {
    struct http_connection *connection; // borrowed; outlives us
    const struct http_route *route;     // borrowed; NULL: answered before one was looked for
    char method[8];
    char *path, *host, *origin, *fetch_site, *token, *known_etag; // owned; all but the path may be NULL
    char *queries[HTTP_QUERY_LIMIT];                              // owned
    size_t query_count;
    bool is_secure;
    bool is_by_cookie;             // the token is the cookie's
    char *body;                    // owned
    size_t body_size, body_length; // `body_length`: as the header has it
    size_t held;                   // bytes of the connection's hold that are its own
    bool has_all;                  // with its body
    void (*on_gone)(void *user);
    void *user;
    // The answer.
    bool is_answered, wants_close;
    unsigned char *head, *content; // owned; each begins with LWS_PRE bytes of room
    size_t head_size, content_size, content_sent;
    bool has_file; // `content` has room for one part of the file
    int file_fd;   // owned
    bool is_head_sent, is_written;
};

// The time from now until which the connection waits; 0: without an end.
void http_connection_wait(struct http_connection *connection, uint64_t time_ms);
// An answer begins to be sent: the connection ends when that takes longer than the settings allow.
void http_connection_begin_sending(struct http_connection *connection);
void http_connection_end_sending(struct http_connection *connection);
void http_connection_kill(struct http_connection *connection); // soon, from the loop
// Whose it is from here on; NULL: the farm does not know.
void http_connection_assign(struct http_connection *connection, const char *user);
struct http_known *http_connection_known(const struct http_connection *connection); // the server's

struct http_request *http_request_create(struct http_connection *connection);
void http_request_destroy(struct http_request *request); // accepts NULL; calls on_gone unless it is answered
// Writes one part of the answer; after the last, `is_written` is true. False: the connection is to be closed.
bool http_request_write(struct http_request *request);
