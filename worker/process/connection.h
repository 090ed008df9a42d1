// The socket to whoever started the worker: whole lines out from any thread, lines in on one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/message_stream.h"

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>

struct error;
struct json_writer;

struct connection {
    int fd; // owned
    struct message_stream stream;
    pthread_mutex_t lock; // one sender at a time
};

void connection_init(struct connection *connection, int fd);
void connection_finish(struct connection *connection);

// Sends what the writer holds (whole messages) and clears it. That nobody listens any more is found out by reading.
void connection_send(struct connection *connection, struct json_writer *writer);

// Takes in what has arrived, waiting if nothing has. False at the end of the stream.
bool connection_receive(struct connection *connection);
// The next line received, as message_stream_next has it.
const char *connection_next(struct connection *connection, size_t *length, struct error *error);
