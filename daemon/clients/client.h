// One client connection: splits bytes into messages, sends answers in any order, slows a client that floods.
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

// The callbacks of a connection. Borrowed while it lives.
struct client_handlers {
    // The message is a request or a notification.
    void (*on_message)(void *user, struct client *client, const struct message *message);
    void (*on_closed)(void *user, struct client *client); // it is freed next: nothing may be sent
    void *user;
};

struct client {
    uv_pipe_t pipe;
    uv_idle_t idle; // active while complete lines wait in `stream`
    const struct client_handlers *handlers;
    struct message_stream stream;
    struct rights_peer peer; // at the time of the connection
    gid_t *groups;           // owned; the peer's
    char *user;              // owned; the peer's user name, or its number
    size_t pending_answers;  // deferred answers that were not sent yet
    int open_handles;
    bool is_reading;
    bool has_ended;  // the peer closed its sending side
    bool is_ignored; // the daemon reads no more messages from it
    bool is_closing;
    uv_shutdown_t shutdown;
    struct client *next, *previous; // on the listener's list
};

// Accepts the connection that waits at `server`; NULL when there is none. The client frees itself after it is closed.
struct client *client_accept(uv_stream_t *server, const struct client_handlers *handlers);
void client_close(struct client *client); // at once; legal twice
// Sends the error, reads no messages, and closes.
void client_refuse(struct client *client, enum message_code code, const char *why);
// Reads no more messages. Deferred answers and events are still sent.
void client_stop_reading(struct client *client);

void client_send(struct client *client, const char *bytes, size_t size_bytes); // copies; does nothing while closing
// The answer to the request `id`. Nothing is sent when `id` is empty: the client wants no answer.
void client_send_result(struct client *client, const char *id, const struct json_writer *value);
void client_send_error(struct client *client, const char *id, enum message_code code, const char *text);
size_t client_backlog_bytes(const struct client *client); // bytes sent that the peer has not read yet

// For an answer that comes later: the client lives at least until client_release, which handles no message itself. A
// client with too many pending answers is not read from.
void client_hold(struct client *client);
void client_release(struct client *client);
