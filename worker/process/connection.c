// SPDX-License-Identifier: Apache-2.0
#include "worker/process/connection.h"

#include "core/base/log.h"
#include "core/json/json_write.h"

#include <errno.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

void connection_init(struct connection *connection, int fd)
{
    *connection = (struct connection){.fd = fd};
    pthread_mutex_init(&connection->lock, NULL);
}

void connection_finish(struct connection *connection)
{
    close(connection->fd);
    message_stream_finish(&connection->stream);
    pthread_mutex_destroy(&connection->lock);
}

void connection_send(struct connection *connection, struct json_writer *writer)
{
    size_t sent = 0;

    pthread_mutex_lock(&connection->lock);
    while (sent < writer->length) {
        ssize_t count = send(connection->fd, writer->text + sent, writer->length - sent, MSG_NOSIGNAL);

        if (count < 0 && errno == EINTR) continue;
        if (count < 0) {
            log_debug("send: %s", strerrordesc_np(errno));
            break;
        }
        sent += (size_t)count;
    }
    pthread_mutex_unlock(&connection->lock);
    json_writer_clear(writer);
}

bool connection_receive(struct connection *connection)
{
    size_t room;
    char *bytes = message_stream_reserve(&connection->stream, &room);
    ssize_t count;

    do
        count = recv(connection->fd, bytes, room, 0);
    while (count < 0 && errno == EINTR);
    if (count <= 0) return false;
    message_stream_commit(&connection->stream, (size_t)count);
    return true;
}

const char *connection_next(struct connection *connection, size_t *length, struct error *error)
{
    return message_stream_next(&connection->stream, length, error);
}
