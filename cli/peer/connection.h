// A JSON-RPC connection to the daemon or a worker, a line for each message: calls, and messages that answer no call.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/exit_status.h"
#include "core/wire/message.h"

#include <stdbool.h>
#include <stdint.h>

struct connection;
struct error;
struct interrupt;
struct json_writer;

// Takes over a connected stream socket. `peer` (borrowed; outlives us) names the other side in messages.
struct connection *connection_adopt(int fd, const char *peer);
void connection_close(struct connection *connection); // accepts NULL
// Waiting ends when `interrupt` (borrowed; outlives us) is requested.
void connection_set_interrupt(struct connection *connection, struct interrupt *interrupt);
// `on_wait` (NULL: none) is called with each message that arrives while a call waits; a busy worker sends one a second.
void connection_set_wait(struct connection *connection, void (*on_wait)(void *user, const struct message *message),
                         void *user);

// The exit status that suits the last failure.
enum exit_status connection_failure(const struct connection *connection);

// Sends whole message lines.
bool connection_send(struct connection *connection, const struct json_writer *lines, struct error *error);
// Sends a request with `params` (one JSON value; NULL: {}) and waits for its answer. On success `reply` is a
// MESSAGE_RESULT to be freed with message_finish. Other messages are kept for connection_next.
bool connection_call(struct connection *connection, const char *method, const char *params, struct message *reply,
                     struct error *error);

enum connection_event {
    CONNECTION_MESSAGE, // `message` is to be freed with message_finish
    CONNECTION_TIMEOUT,
    CONNECTION_INTERRUPTED,
    CONNECTION_CLOSED // the other side is gone or broke the protocol; see `error`
};
// The next message that answers no call. A negative `timeout_ms` waits for ever.
enum connection_event connection_next(struct connection *connection, int64_t timeout_ms, struct message *message,
                                      struct error *error);
