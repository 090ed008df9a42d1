// SPDX-License-Identifier: Apache-2.0
#include "web/farm/farm_connection.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "core/wire/message_stream.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>

enum {
    DROP_ID = 1,
    TOKEN_ID = 2,
    BEGIN_TIME_MS = 15000,       // for the daemon to take the token
    BROKEN_TIME_MS = 100,        // for what the daemon said before it was gone to be read
    WAITING_LIMIT = 1024 * 1024, // bytes; above it, on_drained follows
    ID_TEXT_SIZE = 16
};

static const double LATEST = 1e15; // unix s

enum stage { CONNECTING, DROPPING, ASKING, READY, CLOSED };

struct farm_connection {
    const struct farm_connection_handlers *handlers; // borrowed
    void *user;                                      // borrowed
    char *token;                                     // owned; wiped when it was sent
    struct farm_identity identity;                   // owned
    enum stage stage;
    uv_pipe_t pipe;
    uv_timer_t timer;
    uv_connect_t connect;
    int open_handles;
    struct message_stream stream;
    bool is_paused, was_full, is_reading, is_broken;
    struct error why; // that it ended
};

struct write {
    uv_write_t request;
    size_t length;
    char bytes[];
};

static void on_connected(uv_connect_t *request, int status);
static void on_late(uv_timer_t *timer);
static void on_broken(uv_timer_t *timer);
static void on_room(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer);
static void on_read(uv_stream_t *pipe, ssize_t count, const uv_buf_t *buffer);
static void on_written(uv_write_t *request, int status);
static void on_handle_closed(uv_handle_t *handle);

static void wipe(char *text)
{
    if (text) explicit_bzero(text, strlen(text));
    free(text);
}

struct farm_connection *farm_connection_open(const struct farm_connection_params *params)
{
    struct farm_connection *connection = xcalloc(1, sizeof *connection);

    connection->handlers = params->handlers;
    connection->user = params->user;
    connection->token = params->token ? xstrdup(params->token) : NULL;
    uv_pipe_init(params->loop, &connection->pipe, 0);
    uv_timer_init(params->loop, &connection->timer);
    connection->open_handles = 2;
    connection->pipe.data = connection->timer.data = connection->connect.data = connection;
    uv_timer_start(&connection->timer, on_late, BEGIN_TIME_MS, 0);
    // A path that is too long fails in the callback too.
    uv_pipe_connect(&connection->connect, &connection->pipe, params->socket_path, on_connected);
    return connection;
}

void farm_connection_set_user(struct farm_connection *connection, void *user)
{
    connection->user = user;
}

const struct farm_identity *farm_connection_identity(const struct farm_connection *connection)
{
    return &connection->identity;
}

void farm_connection_close(struct farm_connection *connection)
{
    if (!connection || connection->stage == CLOSED) return;
    connection->stage = CLOSED;
    uv_close((uv_handle_t *)&connection->pipe, on_handle_closed);
    uv_close((uv_handle_t *)&connection->timer, on_handle_closed);
}

static void on_handle_closed(uv_handle_t *handle)
{
    struct farm_connection *connection = handle->data;

    if (--connection->open_handles > 0) return;
    message_stream_finish(&connection->stream);
    wipe(connection->token);
    wipe(connection->identity.session);
    free(connection->identity.user);
    free(connection->identity.scope);
    free(connection);
}

static void end(struct farm_connection *connection, enum farm_end end, const char *why)
{
    if (connection->stage == CLOSED) return;
    error_set(&connection->why, "%s", why);
    farm_connection_close(connection);
    connection->handlers->on_closed(connection->user, end, connection->why.message);
}

static void forget_write(struct write *write)
{
    explicit_bzero(write->bytes, write->length); // it may hold a token
    free(write);
}

// After a write that failed: no answer will come to it. The end follows from the loop, for who sends is not told from
// within.
static void break_off(struct farm_connection *connection, int status)
{
    if (connection->stage == CLOSED || connection->is_broken) return;
    connection->is_broken = true;
    error_set(&connection->why, "%s", uv_strerror(status));
    uv_timer_start(&connection->timer, on_broken, BROKEN_TIME_MS, 0);
}

static void send_line(struct farm_connection *connection, const char *text, size_t length)
{
    struct write *write = xmalloc(sizeof *write + length + 1);
    uv_buf_t buffer = uv_buf_init(write->bytes, (unsigned)(length + 1));
    int status;

    memcpy(write->bytes, text, length);
    for (char *at = write->bytes; (at = memchr(at, '\n', (size_t)(write->bytes + length - at))); at++)
        *at = ' ';
    write->bytes[length] = '\n';
    write->length = length + 1;
    write->request.data = connection;
    status = uv_write(&write->request, (uv_stream_t *)&connection->pipe, &buffer, 1, on_written);
    if (status != 0) {
        forget_write(write);
        break_off(connection, status);
    }
    if (farm_connection_is_full(connection)) connection->was_full = true;
}

void farm_connection_send(struct farm_connection *connection, const char *text, size_t length)
{
    if (connection->stage == READY) send_line(connection, text, length);
}

size_t farm_connection_waiting(const struct farm_connection *connection)
{
    return uv_stream_get_write_queue_size((const uv_stream_t *)&connection->pipe);
}

bool farm_connection_is_full(const struct farm_connection *connection)
{
    return farm_connection_waiting(connection) > WAITING_LIMIT;
}

static void on_written(uv_write_t *request, int status)
{
    struct write *write = (struct write *)request;
    struct farm_connection *connection = request->data;

    forget_write(write);
    if (status != 0) break_off(connection, status);
    if (status != 0 || connection->stage != READY || !connection->was_full || farm_connection_is_full(connection))
        return;
    connection->was_full = false;
    connection->handlers->on_drained(connection->user);
}

static void read_on(struct farm_connection *connection)
{
    bool wants_reading = connection->stage != CLOSED && !connection->is_paused;

    if (wants_reading == connection->is_reading) return;
    connection->is_reading = wants_reading;
    if (wants_reading)
        uv_read_start((uv_stream_t *)&connection->pipe, on_room, on_read);
    else
        uv_read_stop((uv_stream_t *)&connection->pipe);
}

static void call_first(struct farm_connection *connection, int64_t id, const char *method, const char *token)
{
    struct json_writer writer = {0};

    message_begin_request(&writer, id, method);
    json_write_begin_object(&writer);
    if (token) json_write_string_member(&writer, "token", token);
    json_write_end_object(&writer);
    message_end(&writer);
    send_line(connection, writer.text, writer.length - 1);
    explicit_bzero(writer.text, writer.length);
    json_writer_finish(&writer);
}

static void on_connected(uv_connect_t *request, int status)
{
    struct farm_connection *connection = request->data;

    if (connection->stage == CLOSED) return;
    if (status != 0) {
        end(connection, FARM_AWAY, uv_strerror(status));
        return;
    }
    connection->stage = DROPPING;
    read_on(connection);
    call_first(connection, DROP_ID, "auth.drop", NULL);
}

static void on_late(uv_timer_t *timer)
{
    end(timer->data, FARM_AWAY, "it does not answer");
}

static void on_broken(uv_timer_t *timer)
{
    struct farm_connection *connection = timer->data;
    struct error why = connection->why;

    end(connection, FARM_AWAY, why.message);
}

static void on_room(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer)
{
    struct farm_connection *connection = handle->data;
    size_t room;

    (void)suggested;
    buffer->base = message_stream_reserve(&connection->stream, &room);
    buffer->len = room;
}

static bool read_text(const struct json_node *result, const char *key, char **text, struct error *error)
{
    struct json_node node = json_node_child(result, key);
    const char *read;

    if (!json_read_string(&node, &read, error)) return false;
    *text = xstrdup(read);
    return true;
}

static bool read_identity(struct farm_identity *identity, const struct json_node *result, struct error *error)
{
    struct json_node expires = json_node_child(result, "expires"), session = json_node_child(result, "session");

    identity->has_expiry = json_node_type(&expires) == JSON_NUMBER;
    if (identity->has_expiry && !json_read_number(&expires, 0, LATEST, &identity->expires, error)) return false;
    if (json_node_type(&session) == JSON_STRING && !read_text(result, "session", &identity->session, error))
        return false;
    return read_text(result, "user", &identity->user, error) && read_text(result, "scope", &identity->scope, error);
}

static void become_ready(struct farm_connection *connection)
{
    connection->stage = READY;
    if (!connection->is_broken) uv_timer_stop(&connection->timer);
    connection->handlers->on_ready(connection->user, &connection->identity);
}

// An answer before the connection is ready. Anything unexpected ends it: no message may be sent with our own rights.
static void take_first(struct farm_connection *connection, const struct message *message)
{
    char expected[ID_TEXT_SIZE];
    struct error error = {0};

    snprintf(expected, sizeof expected, "%d", connection->stage == DROPPING ? DROP_ID : TOKEN_ID);
    if (strcmp(message->id, expected) != 0) { // it does not take us: too many connections
        end(connection, FARM_AWAY, message->kind == MESSAGE_ERROR ? message->text : "an answer to nothing");
    } else if (connection->stage == DROPPING && message->kind == MESSAGE_RESULT && !connection->token) {
        become_ready(connection);
    } else if (connection->stage == DROPPING && message->kind == MESSAGE_RESULT) {
        connection->stage = ASKING;
        call_first(connection, TOKEN_ID, "auth.token", connection->token);
        wipe(connection->token);
        connection->token = NULL;
    } else if (connection->stage == ASKING && message->kind == MESSAGE_RESULT) {
        if (read_identity(&connection->identity, &message->body, &error))
            become_ready(connection);
        else
            end(connection, FARM_FAULT, error.message);
    } else {
        bool is_refused =
            connection->stage == ASKING && message->kind == MESSAGE_ERROR && message->code == MESSAGE_CODE_NOT_ALLOWED;

        end(connection, is_refused ? FARM_REFUSED : FARM_FAULT,
            message->kind == MESSAGE_ERROR ? message->text : "auth.drop or auth.token is not answered");
    }
}

static void take_line(struct farm_connection *connection, const char *line, size_t length)
{
    struct message message = {0};
    enum message_code code;
    struct error error = {0};

    if (connection->stage == READY)
        connection->handlers->on_line(connection->user, line, length);
    else if (message_decode(&message, line, length, &code, &error))
        take_first(connection, &message);
    else
        end(connection, FARM_FAULT, error.message);
    message_finish(&message);
}

static void on_read(uv_stream_t *pipe, ssize_t count, const uv_buf_t *buffer)
{
    struct farm_connection *connection = pipe->data;
    struct error error = {0};
    const char *line;
    size_t length;

    (void)buffer;
    if (count > 0) message_stream_commit(&connection->stream, (size_t)count);
    while (connection->stage != CLOSED && (line = message_stream_next(&connection->stream, &length, &error)))
        take_line(connection, line, length);
    if (error.message[0]) end(connection, FARM_FAULT, error.message);
    if (count < 0)
        end(connection, FARM_AWAY, count == UV_EOF ? "it has closed the connection" : uv_strerror((int)count));
}

void farm_connection_pause(struct farm_connection *connection, bool is_paused)
{
    connection->is_paused = is_paused;
    read_on(connection);
}
