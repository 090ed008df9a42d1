// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_socket.h"

#include "core/base/alloc.h"
#include "core/base/log.h"
#include "core/wire/message_stream.h"
#include "web/http/http_connection.h"
#include "web/http/http_socket_events.h"

#include <stdlib.h>
#include <string.h>

enum { TURN_LIMIT = 64, CLOSE_TIME_MS = 10000, REASON_LIMIT = 100 };

static const char too_much[] = "too much waits here already";

// A message that waits.
struct outgoing {
    struct outgoing *next; // on the socket's list
    size_t length;
    unsigned char bytes[]; // LWS_PRE bytes of room, then the text
};

struct http_socket {
    struct http_connection *connection; // borrowed; outlives us
    const struct http_socket_handlers *handlers;
    void *user, *link;              // borrowed; `link` is NULL before on_open
    struct outgoing *first, **last; // owned
    size_t waiting_bytes, beside_bytes;
    bool was_full, is_paused;
    char *message; // owned; what has come of the one that is read
    size_t message_length, message_capacity;
    enum http_socket_code close_code; // 0: it is open
    const char *close_reason;         // static; at most REASON_LIMIT bytes
    bool is_end_said;
};

struct http_socket *http_socket_create(struct http_connection *connection, const struct http_socket_handlers *handlers,
                                       void *user)
{
    struct http_socket *socket = xcalloc(1, sizeof *socket);

    *socket = (struct http_socket){.connection = connection, .handlers = handlers, .user = user};
    socket->last = &socket->first;
    return socket;
}

static void drop_first(struct http_socket *socket)
{
    struct outgoing *first = socket->first;

    socket->first = first->next;
    if (!socket->first) socket->last = &socket->first;
    socket->waiting_bytes -= first->length;
    http_hold_give(&socket->connection->hold, sizeof *first + LWS_PRE + first->length);
    free(first);
}

static void drop_message(struct http_socket *socket)
{
    http_hold_give(&socket->connection->hold, socket->message_capacity);
    free(socket->message);
    socket->message = NULL;
    socket->message_length = socket->message_capacity = 0;
}

void http_socket_destroy(struct http_socket *socket)
{
    if (!socket) return;
    if (socket->link) socket->handlers->on_closed(socket->link);
    while (socket->first)
        drop_first(socket);
    drop_message(socket);
    http_hold_give(&socket->connection->hold, socket->beside_bytes);
    free(socket);
}

void http_socket_set_user(struct http_socket *socket, const char *user)
{
    http_connection_assign(socket->connection, user);
}

// More than the client may have in memory would wait: what waits is dropped, for who does not read would keep it.
static void give_up(struct http_socket *socket)
{
    log_debug("%s: a WebSocket ends: %s", socket->connection->peer.address, too_much);
    while (socket->first)
        drop_first(socket);
    http_socket_close(socket, HTTP_SOCKET_TRY_LATER, too_much);
}

void http_socket_set_beside(struct http_socket *socket, size_t size_bytes)
{
    http_hold_give(&socket->connection->hold, socket->beside_bytes);
    socket->beside_bytes = 0;
    if (http_hold_take(&socket->connection->hold, size_bytes))
        socket->beside_bytes = size_bytes;
    else
        give_up(socket);
}

void http_socket_send(struct http_socket *socket, const char *text, size_t length)
{
    struct outgoing *outgoing;

    if (socket->close_code) return;
    if (!http_hold_take(&socket->connection->hold, sizeof *outgoing + LWS_PRE + length)) {
        give_up(socket);
        return;
    }
    outgoing = xmalloc(sizeof *outgoing + LWS_PRE + length);
    outgoing->next = NULL;
    outgoing->length = length;
    memcpy(outgoing->bytes + LWS_PRE, text, length);
    *socket->last = outgoing;
    socket->last = &outgoing->next;
    socket->waiting_bytes += length;
    if (!socket->was_full && http_socket_is_full(socket)) {
        socket->was_full = true;
        http_connection_begin_sending(socket->connection);
        http_connection_wait(socket->connection, 0);
    }
    lws_callback_on_writable(socket->connection->wsi);
}

bool http_socket_is_full(const struct http_socket *socket)
{
    return socket->waiting_bytes > HTTP_SOCKET_WAITING_LIMIT;
}

void http_socket_pause(struct http_socket *socket, bool is_paused)
{
    if (socket->is_paused == is_paused) return;
    socket->is_paused = is_paused;
    lws_rx_flow_control(socket->connection->wsi, is_paused ? 0 : 1);
}

void http_socket_close(struct http_socket *socket, enum http_socket_code code, const char *reason)
{
    if (socket->close_code) return;
    socket->close_code = code;
    socket->close_reason = reason;
    http_connection_wait(socket->connection, CLOSE_TIME_MS);
    lws_callback_on_writable(socket->connection->wsi);
}

int http_socket_on_established(struct http_socket *socket, const char *token)
{
    http_connection_wait(socket->connection, 0);
    socket->link = socket->handlers->on_open(socket->user, socket, token);
    return 0;
}

// Says why. The connection ends when the client has said the same, or at its deadline: libwebsockets' own way to close,
// with its loop of libuv, ends the connection before the reason has left.
static int say_end(struct http_socket *socket)
{
    unsigned char frame[LWS_PRE + 4 + REASON_LIMIT], *bytes = frame + LWS_PRE;
    size_t length = strlen(socket->close_reason);

    socket->is_end_said = true;
    bytes[0] = 0x88; // a whole frame that closes
    bytes[1] = (unsigned char)(2 + length);
    bytes[2] = (unsigned char)(socket->close_code >> 8);
    bytes[3] = (unsigned char)(socket->close_code & 0xff);
    memcpy(bytes + 4, socket->close_reason, length);
    return lws_write(socket->connection->wsi, bytes, 4 + length, LWS_WRITE_RAW) < 0 ? -1 : 0;
}

static int end(struct http_socket *socket, enum http_socket_code code, const char *reason)
{
    http_socket_close(socket, code, reason);
    return 0;
}

// False: too much waits already.
static bool make_room(struct http_socket *socket, size_t wanted)
{
    size_t capacity = socket->message_capacity;

    while (capacity < wanted)
        capacity = capacity ? 2 * capacity : HTTP_SMALL_SIZE;
    if (!http_hold_take(&socket->connection->hold, capacity - socket->message_capacity)) return false;
    socket->message = xrealloc(socket->message, capacity);
    socket->message_capacity = capacity;
    return true;
}

int http_socket_on_receive(struct http_socket *socket, const char *bytes, size_t size)
{
    struct lws *wsi = socket->connection->wsi;

    if (socket->close_code) return 0;
    if (lws_frame_is_binary(wsi)) return end(socket, HTTP_SOCKET_NO_TEXT, "expected text");
    if (socket->message_length + size > MESSAGE_LINE_LIMIT)
        return end(socket, HTTP_SOCKET_TOO_BIG, "a message has at most 4 MiB");
    if (!make_room(socket, socket->message_length + size + 1)) return end(socket, HTTP_SOCKET_TRY_LATER, too_much);
    memcpy(socket->message + socket->message_length, bytes, size);
    socket->message_length += size;
    if (!lws_is_final_fragment(wsi)) return 0;
    socket->message[socket->message_length] = '\0';
    if (socket->link) socket->handlers->on_message(socket->link, socket->message, socket->message_length);
    drop_message(socket);
    return 0;
}

int http_socket_on_writable(struct http_socket *socket)
{
    struct lws *wsi = socket->connection->wsi;

    for (int i = 0; i < TURN_LIMIT && socket->first && !lws_send_pipe_choked(wsi); i++) {
        if (lws_write(wsi, socket->first->bytes + LWS_PRE, socket->first->length, LWS_WRITE_TEXT) < 0) return -1;
        drop_first(socket);
    }
    if (socket->first) {
        lws_callback_on_writable(wsi);
    } else if (socket->close_code) {
        return socket->is_end_said ? 0 : say_end(socket);
    }
    if (socket->was_full && !http_socket_is_full(socket)) {
        socket->was_full = false;
        if (!socket->close_code) http_connection_end_sending(socket->connection);
        if (socket->link) socket->handlers->on_drained(socket->link);
    }
    return 0;
}
