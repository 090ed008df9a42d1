// SPDX-License-Identifier: Apache-2.0
#include "cli/peer/connection.h"

#include "cli/program/interrupt.h"
#include "cli/terminal/progress.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_write.h"
#include "core/wire/message_stream.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

struct connection {
    int fd;
    const char *peer;            // borrowed
    struct interrupt *interrupt; // borrowed; may be NULL
    struct message_stream stream;
    struct message *kept; // owned; arrived during a call, oldest first
    size_t kept_count, kept_capacity, kept_start;
    int64_t last_id;
    enum exit_status failure;
    void (*on_wait)(void *user, const struct message *message); // NULL: none
    void *wait_user;
};

struct connection *connection_adopt(int fd, const char *peer)
{
    struct connection *connection = xcalloc(1, sizeof *connection);

    connection->fd = fd;
    connection->peer = peer;
    connection->failure = EXIT_STATUS_FAILED;
    return connection;
}

void connection_close(struct connection *connection)
{
    if (!connection) return;
    close(connection->fd);
    message_stream_finish(&connection->stream);
    for (size_t i = connection->kept_start; i < connection->kept_count; i++)
        message_finish(&connection->kept[i]);
    free(connection->kept);
    free(connection);
}

void connection_set_wait(struct connection *connection, void (*on_wait)(void *user, const struct message *message),
                         void *user)
{
    connection->on_wait = on_wait;
    connection->wait_user = user;
}

void connection_set_interrupt(struct connection *connection, struct interrupt *interrupt)
{
    connection->interrupt = interrupt;
}

enum exit_status connection_failure(const struct connection *connection)
{
    return connection->failure;
}

bool connection_send(struct connection *connection, const struct json_writer *lines, struct error *error)
{
    size_t sent = 0;

    while (sent < lines->length) {
        ssize_t count = send(connection->fd, lines->text + sent, lines->length - sent, MSG_NOSIGNAL);

        if (count >= 0) {
            sent += (size_t)count;
        } else if (errno != EINTR) {
            connection->failure = EXIT_STATUS_NO_DAEMON;
            error_set_errno(error, errno, "%s takes no messages", connection->peer);
            return false;
        }
    }
    return true;
}

// Waits until there are bytes to read.
static enum connection_event await_bytes(struct connection *connection, int64_t deadline_ms)
{
    struct pollfd polled[2] = {{.fd = connection->fd, .events = POLLIN}, {.fd = -1, .events = POLLIN}};

    if (connection->interrupt && connection->interrupt->fd > 0) polled[1].fd = connection->interrupt->fd;
    for (;;) {
        int64_t left = deadline_ms < 0 ? -1 : deadline_ms - progress_now_ms();
        int count;

        if (deadline_ms >= 0 && left < 0) left = 0;
        count = poll(polled, 2, left > 1000000 ? 1000000 : (int)left);
        if (interrupt_is_requested(connection->interrupt)) return CONNECTION_INTERRUPTED;
        if (count > 0 && polled[0].revents) return CONNECTION_MESSAGE;
        if (count == 0 && left <= 1000000) return CONNECTION_TIMEOUT;
    }
}

static enum connection_event read_bytes(struct connection *connection, struct error *error)
{
    size_t room;
    char *bytes = message_stream_reserve(&connection->stream, &room);
    ssize_t count = read(connection->fd, bytes, room);

    if (count > 0) {
        message_stream_commit(&connection->stream, (size_t)count);
        return CONNECTION_MESSAGE;
    }
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) return CONNECTION_MESSAGE;
    connection->failure = EXIT_STATUS_NO_DAEMON;
    if (count < 0)
        error_set_errno(error, errno, "%s is gone", connection->peer);
    else
        error_set(error, "%s closed the connection", connection->peer);
    return CONNECTION_CLOSED;
}

// The next message from the socket, an answer or another one.
static enum connection_event receive(struct connection *connection, int64_t timeout_ms, struct message *message,
                                     struct error *error)
{
    int64_t deadline_ms = timeout_ms < 0 ? -1 : progress_now_ms() + timeout_ms;

    for (;;) {
        struct error local = {0};
        enum message_code code;
        enum connection_event event;
        size_t length;
        const char *line = message_stream_next(&connection->stream, &length, &local);

        if (line && message_decode(message, line, length, &code, &local)) return CONNECTION_MESSAGE;
        if (local.message[0]) {
            connection->failure = EXIT_STATUS_FAILED;
            error_set(error, "%s sent what is no message: %s", connection->peer, local.message);
            return CONNECTION_CLOSED;
        }
        event = await_bytes(connection, deadline_ms);
        if (event == CONNECTION_MESSAGE) event = read_bytes(connection, error);
        if (event != CONNECTION_MESSAGE) return event;
    }
}

static void keep(struct connection *connection, const struct message *message)
{
    connection->kept =
        xgrow(connection->kept, &connection->kept_capacity, connection->kept_count + 1, sizeof *connection->kept);
    connection->kept[connection->kept_count++] = *message;
}

static enum exit_status status_of_code(int code)
{
    switch (code) {
    case MESSAGE_CODE_NOT_ALLOWED:
        return EXIT_STATUS_NOT_ALLOWED;
    case MESSAGE_CODE_PARSE:
    case MESSAGE_CODE_INVALID:
    case MESSAGE_CODE_PARAMS:
        return EXIT_STATUS_USAGE;
    default:
        return EXIT_STATUS_FAILED;
    }
}

// True when `message` answers the call with that id. An error without an id answers the one open call.
static bool is_answer(const struct message *message, const char *id)
{
    if (message->kind == MESSAGE_ERROR && (!message->id[0] || strcmp(message->id, "null") == 0)) return true;
    return (message->kind == MESSAGE_RESULT || message->kind == MESSAGE_ERROR) && strcmp(message->id, id) == 0;
}

static bool await_answer(struct connection *connection, const char *id, struct message *reply, struct error *error)
{
    for (;;) {
        enum connection_event event = receive(connection, -1, reply, error);

        if (event == CONNECTION_INTERRUPTED) {
            connection->failure = EXIT_STATUS_INTERRUPTED;
            error_set(error, "interrupted");
        }
        if (event != CONNECTION_MESSAGE) return false;
        if (!is_answer(reply, id)) {
            if (connection->on_wait) connection->on_wait(connection->wait_user, reply);
            keep(connection, reply);
            continue;
        }
        if (reply->kind == MESSAGE_RESULT) return true;
        connection->failure = status_of_code(reply->code);
        error_set(error, "%s", reply->text ? reply->text : "failed without saying why");
        message_finish(reply);
        return false;
    }
}

bool connection_call(struct connection *connection, const char *method, const char *params, struct message *reply,
                     struct error *error)
{
    struct json_writer line = {0};
    char id[32];
    bool ok;

    snprintf(id, sizeof id, "%" PRId64, ++connection->last_id);
    message_begin_request(&line, connection->last_id, method);
    json_write_raw(&line, params ? params : "{}", params ? strlen(params) : 2);
    message_end(&line);
    // A peer that closed may have sent the reason before.
    connection_send(connection, &line, error);
    ok = await_answer(connection, id, reply, error);
    json_writer_finish(&line);
    return ok;
}

enum connection_event connection_next(struct connection *connection, int64_t timeout_ms, struct message *message,
                                      struct error *error)
{
    if (connection->kept_start < connection->kept_count) {
        *message = connection->kept[connection->kept_start++];
        if (connection->kept_start == connection->kept_count) connection->kept_start = connection->kept_count = 0;
        return CONNECTION_MESSAGE;
    }
    return receive(connection, timeout_ms, message, error);
}
