// One connection: cuts its bytes into messages, answers in any order, and pays alone for what it floods.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/message.h"
#include "core/wire/message_stream.h"
#include "daemon/users/rights.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <uv.h>

struct client;
struct json_writer;

// What a connection needs from outside; lent for as long as it lives.
struct client_handlers {
    void (*on_message)(void *user, struct client *client, const struct message *message); // a request or notification
    void (*on_closed)(void *user, struct client *client); // nothing may be sent any more; it is about to be freed
    void *user;
};

struct client {
    uv_pipe_t pipe;
    uv_idle_t idle; // active while whole lines wait in `stream`
    const struct client_handlers *handlers;
    struct message_stream stream;
    struct rights_peer peer; // as it was when it connected
    gid_t *groups;           // owned; the peer's
    char *user;              // owned; the peer's user name, or its number
    size_t pending_answers;  // answers that are still being made
    int open_handles;
    bool is_reading;
    bool has_ended;  // the peer sends no more
    bool is_ignored; // the daemon takes no more from it
    bool is_closing;
    uv_shutdown_t shutdown;
    struct client *next, *previous; // on the listener's list
};

// Takes the connection that waits at `server`; NULL when there is none. It frees itself after it is closed.
struct client *client_accept(uv_stream_t *server, const struct client_handlers *handlers);
void client_close(struct client *client); // at once; legal twice
// Takes no messages from it, says why, and closes.
void client_refuse(struct client *client, enum message_code code, const char *why);
// Takes no more messages from it; what it is owed or subscribed to still goes out.
void client_stop_reading(struct client *client);

void client_send(struct client *client, const char *bytes, size_t size_bytes); // copies; nothing when it is closing
// The answer to the request `id`; nothing when `id` is empty, for then the client wants no answer.
void client_send_result(struct client *client, const char *id, const struct json_writer *value);
void client_send_error(struct client *client, const char *id, enum message_code code, const char *text);
size_t client_backlog_bytes(const struct client *client); // sent, not yet taken by the peer

// An answer that comes later: the client lives at least until client_release, which hears no message itself, and takes no
// new message while it is owed too many.
void client_hold(struct client *client);
void client_release(struct client *client);
