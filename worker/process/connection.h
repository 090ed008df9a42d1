// The socket to the program that started the worker. Any thread sends whole lines; one thread receives lines.
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

// Sends the whole messages that the writer holds and clears it. Errors are only logged: reading shows that the peer is
// gone.
void connection_send(struct connection *connection, struct json_writer *writer);

// Receives bytes, waiting for some. False at the end of the stream.
bool connection_receive(struct connection *connection);
// The next received line, as message_stream_next returns it.
const char *connection_next(struct connection *connection, size_t *length, struct error *error);
