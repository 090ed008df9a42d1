// SPDX-License-Identifier: Apache-2.0
#include "daemon/clients/client.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/json/json_write.h"

#include <errno.h>
#include <pwd.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

enum {
    ITERATION_MESSAGE_LIMIT = 64,   // messages of one client in one iteration of the loop
    PENDING_LIMIT = 16,             // pending answers of one client
    FIRST_GROUPS = 64,              // room for groups of a peer at first; there may be more
    BACKLOG_LIMIT = 1 * 1024 * 1024 // bytes the peer has not read, above which its messages wait
};

static const char no_id[] = "null"; // the id of an error that belongs to no request

struct client_write {
    uv_write_t request;
    struct client *client; // borrowed; a write ends before its pipe is closed
    char bytes[];
};

static void on_allocate(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer);
static void on_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buffer);
static void on_idle(uv_idle_t *idle);
static void on_written(uv_write_t *request, int status);
static void on_shutdown(uv_shutdown_t *request, int status);
static void on_handle_closed(uv_handle_t *handle);
static void pump(struct client *client);

// Supplementary groups of the peer, then its primary group, which SO_PEERGROUPS leaves out.
static void read_groups(struct client *client, int fd, gid_t primary)
{
    socklen_t size = FIRST_GROUPS * sizeof(gid_t);
    int result = -1;

    for (int tries = 0; tries < 2 && result != 0; tries++) {
        client->groups = xrealloc(client->groups, size + sizeof(gid_t));
        result = getsockopt(fd, SOL_SOCKET, SO_PEERGROUPS, client->groups, &size);
        if (result != 0 && errno != ERANGE) break;
    }
    if (result != 0) size = 0;
    client->peer.group_count = size / sizeof(gid_t);
    client->groups[client->peer.group_count++] = primary;
    client->peer.groups = client->groups;
}

static void read_peer(struct client *client)
{
    struct ucred peer = {.uid = (uid_t)-1, .gid = (gid_t)-1};
    socklen_t length = sizeof peer;
    struct passwd entry, *found = NULL;
    char text[4096];
    uv_os_fd_t fd;

    client->peer.uid = -1;
    if (uv_fileno((uv_handle_t *)&client->pipe, &fd) == 0 &&
        getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &length) == 0 && peer.uid != (uid_t)-1) {
        client->peer.uid = peer.uid;
        read_groups(client, fd, peer.gid);
    }
    if (client->peer.uid >= 0 && getpwuid_r(peer.uid, &entry, text, sizeof text, &found) == 0 && found)
        client->user = xstrdup(entry.pw_name);
    else
        client->user = xasprintf("%lld", (long long)client->peer.uid);
}

struct client *client_accept(uv_stream_t *server, const struct client_handlers *handlers)
{
    struct client *client = xcalloc(1, sizeof *client);

    client->handlers = handlers;
    uv_pipe_init(server->loop, &client->pipe, 0);
    uv_idle_init(server->loop, &client->idle);
    client->pipe.data = client->idle.data = client;
    client->open_handles = 2;
    if (uv_accept(server, (uv_stream_t *)&client->pipe) != 0) {
        client->is_closing = true;
        uv_close((uv_handle_t *)&client->pipe, on_handle_closed);
        uv_close((uv_handle_t *)&client->idle, on_handle_closed);
        return NULL;
    }
    read_peer(client);
    pump(client);
    return client;
}

static void set_reading(struct client *client, bool reading)
{
    if (reading == client->is_reading) return;
    client->is_reading = reading;
    if (reading)
        uv_read_start((uv_stream_t *)&client->pipe, on_allocate, on_read);
    else
        uv_read_stop((uv_stream_t *)&client->pipe);
}

static void on_allocate(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer)
{
    struct client *client = handle->data;
    size_t room;
    char *bytes = message_stream_reserve(&client->stream, &room);

    *buffer = uv_buf_init(bytes, (unsigned)(room < suggested ? room : suggested));
}

static void on_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buffer)
{
    struct client *client = stream->data;

    if (count == 0) return;
    if (count > 0) {
        message_stream_commit(&client->stream, (size_t)count);
    } else if (count == UV_EOF) {
        client->has_ended = true;
        set_reading(client, false);
    } else {
        client_close(client);
        return;
    }
    pump(client);
}

static void on_idle(uv_idle_t *idle)
{
    pump(idle->data);
}

static bool has_room(const struct client *client)
{
    return !client->is_closing && !client->is_ignored && client->pending_answers < PENDING_LIMIT &&
           client_backlog_bytes(client) < BACKLOG_LIMIT;
}

static void handle_line(struct client *client, const char *line, size_t length)
{
    struct message message = {0};
    enum message_code code = MESSAGE_CODE_PARSE;
    struct error error = {0};

    if (length == 0) return;
    if (!message_decode(&message, line, length, &code, &error))
        client_send_error(client, message.id[0] ? message.id : no_id, code, error.message);
    else if (message.kind == MESSAGE_REQUEST || message.kind == MESSAGE_NOTIFICATION)
        client->handlers->on_message(client->handlers->user, client, &message);
    else
        client_send_error(client, message.id[0] ? message.id : no_id, MESSAGE_CODE_INVALID,
                          "expected a request: the daemon sends none");
    message_finish(&message);
}

// Sends what is waiting, then closes.
static void end(struct client *client)
{
    set_reading(client, false);
    client->is_closing = true;
    client->shutdown.data = client;
    if (uv_shutdown(&client->shutdown, (uv_stream_t *)&client->pipe, on_shutdown) != 0)
        on_shutdown(&client->shutdown, 0);
}

// Handles messages as far as the limits allow, then decides what to wait for: bytes, the next iteration, or room.
static void pump(struct client *client)
{
    struct error error = {0};
    const char *line = NULL;
    size_t length, taken = 0;

    while (has_room(client) && taken < ITERATION_MESSAGE_LIMIT) {
        line = message_stream_next(&client->stream, &length, &error);
        if (!line) break;
        handle_line(client, line, length);
        taken++;
    }
    if (client->is_closing) return;
    if (error.message[0]) {
        client_send_error(client, no_id, MESSAGE_CODE_INVALID, error.message);
        end(client);
    } else if (has_room(client) && taken == ITERATION_MESSAGE_LIMIT) {
        set_reading(client, false);
        uv_idle_start(&client->idle, on_idle);
    } else {
        uv_idle_stop(&client->idle);
        set_reading(client, has_room(client) && !client->has_ended);
        if (has_room(client) && client->has_ended && client->pending_answers == 0) end(client);
    }
}

void client_refuse(struct client *client, enum message_code code, const char *why)
{
    client_send_error(client, no_id, code, why);
    if (!client->is_closing) end(client);
}

void client_stop_reading(struct client *client)
{
    client->is_ignored = true;
    pump(client);
}

void client_send(struct client *client, const char *bytes, size_t size_bytes)
{
    struct client_write *write;
    uv_buf_t buffer;

    if (client->is_closing) return;
    write = xmalloc(sizeof *write + size_bytes);
    write->client = client;
    memcpy(write->bytes, bytes, size_bytes);
    buffer = uv_buf_init(write->bytes, (unsigned)size_bytes);
    if (uv_write(&write->request, (uv_stream_t *)&client->pipe, &buffer, 1, on_written) == 0) return;
    free(write);
    client_close(client);
}

void client_send_result(struct client *client, const char *id, const struct json_writer *value)
{
    struct json_writer writer = {0};

    if (!id[0]) return;
    message_begin_result(&writer, id);
    json_write_raw(&writer, value->text, value->length);
    message_end(&writer);
    client_send(client, writer.text, writer.length);
    json_writer_finish(&writer);
}

void client_send_error(struct client *client, const char *id, enum message_code code, const char *text)
{
    struct json_writer writer = {0};

    if (!id[0]) return;
    message_write_error(&writer, id, code, text);
    client_send(client, writer.text, writer.length);
    json_writer_finish(&writer);
}

static void on_written(uv_write_t *request, int status)
{
    struct client_write *write = (struct client_write *)request;
    struct client *client = write->client;

    free(write);
    if (client->is_closing) return;
    if (status != 0)
        client_close(client);
    else if (!client->is_reading && !uv_is_active((uv_handle_t *)&client->idle))
        pump(client);
}

size_t client_backlog_bytes(const struct client *client)
{
    return uv_stream_get_write_queue_size((const uv_stream_t *)&client->pipe);
}

static void on_shutdown(uv_shutdown_t *request, int status)
{
    struct client *client = request->data;

    client_close(client);
}

void client_close(struct client *client)
{
    client->is_closing = true;
    if (uv_is_closing((uv_handle_t *)&client->pipe)) return;
    uv_close((uv_handle_t *)&client->pipe, on_handle_closed);
    uv_close((uv_handle_t *)&client->idle, on_handle_closed);
}

static void free_if_done(struct client *client)
{
    if (client->open_handles > 0 || client->pending_answers > 0) return;
    message_stream_finish(&client->stream);
    free(client->groups);
    free(client->user);
    free(client);
}

static void on_handle_closed(uv_handle_t *handle)
{
    struct client *client = handle->data;

    if (--client->open_handles > 0) return;
    if (client->user) client->handlers->on_closed(client->handlers->user, client);
    free_if_done(client);
}

void client_hold(struct client *client)
{
    client->pending_answers++;
}

void client_release(struct client *client)
{
    client->pending_answers--;
    if (client->open_handles == 0)
        free_if_done(client);
    else if (!client->is_closing)
        // The next message is handled in the next iteration: it may concern what the caller is still changing.
        uv_idle_start(&client->idle, on_idle);
}
