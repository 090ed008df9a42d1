// Talks JSON-RPC, a line a message, with the daemon or a worker: asks and waits, and hands over what comes unasked.
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

// Takes a connected stream socket over; `peer` (borrowed; outlives us) names the other side in messages.
struct connection *connection_adopt(int fd, const char *peer);
void connection_close(struct connection *connection); // accepts NULL
// Waiting ends when `interrupt` (borrowed; outlives us) is requested.
void connection_set_interrupt(struct connection *connection, struct interrupt *interrupt);
// `on_wait` (NULL: nobody) hears of each message that comes while an answer is waited for; of a worker that works one a second.
void connection_set_wait(struct connection *connection, void (*on_wait)(void *user), void *user);

// What the program's exit code should be after the last failure.
enum exit_status connection_failure(const struct connection *connection);

// Sends whole message lines.
bool connection_send(struct connection *connection, const struct json_writer *lines, struct error *error);
// Sends a request with `params` (one JSON value; NULL: {}) and waits for its answer. On success `reply` is a
// MESSAGE_RESULT to be freed with message_finish; what comes meanwhile is kept for connection_next.
bool connection_call(struct connection *connection, const char *method, const char *params, struct message *reply,
                     struct error *error);

enum connection_event {
    CONNECTION_MESSAGE, // `message` is to be freed with message_finish
    CONNECTION_TIMEOUT,
    CONNECTION_INTERRUPTED,
    CONNECTION_CLOSED // the other side is gone or talks nonsense: `error` says so
};
// The next message that answers nothing. `timeout_ms` negative: as long as it takes.
enum connection_event connection_next(struct connection *connection, int64_t timeout_ms, struct message *message,
                                      struct error *error);
