// SPDX-License-Identifier: Apache-2.0
#include "daemon/clients/client.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/json/json_write.h"
#include "daemon/clients/client_account.h"
#include "daemon/clients/client_peer.h"
#include "daemon/clients/shared_text.h"
#include "daemon/loop/memory_return.h"
#include "daemon/loop/work_desk.h"

#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum {
    UNREAD_LIMIT = 1024 * 1024,           // bytes the peer has not read, above which its messages wait
    USER_UNREAD_LIMIT = 64 * 1024 * 1024, // the same of all connections of its user
    USER_EVENTS_LIMIT = 16 * 1024 * 1024, // bytes of events that wait for a user's connections
    STUCK_CHECKS = 6,                     // see client_check_stuck
    SHORT_VALUE = 4096                    // bytes of an answer that is copied into one text with what is around it
};

static const char no_id[] = "null"; // the id of an error that belongs to no request

// A long message while it is read in a thread, handled, and freed in a thread.
struct long_line {
    struct work_piece piece;
    struct client *client; // held until the message is handled
    char *bytes;           // owned; the line begins at `start`
    size_t start, length;
    struct message message;
    enum message_code code;
    struct error error;
    bool ok;
};

static void on_allocate(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer);
static void on_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buffer);
static bool on_step(struct loop_task *task);
static void on_decode_run(struct work_piece *piece);
static void on_decode_done(struct work_piece *piece, bool was_run);
static void on_discard_run(struct work_piece *piece);
static void on_discard_done(struct work_piece *piece, bool was_run);
static void on_written(void *user, int status);
static void on_shutdown(uv_shutdown_t *request, int status);
static void on_pipe_closed(uv_handle_t *handle);

struct client *client_create(const struct client_host *host, int fd)
{
    struct client *client = xcalloc(1, sizeof *client);
    uv_os_fd_t opened;

    client->host = host;
    client->task.step = on_step;
    uv_pipe_init(host->loop, &client->pipe, 0);
    client->pipe.data = client;
    client->outgoing =
        (struct outgoing){.stream = (uv_stream_t *)&client->pipe, .on_written = on_written, .user = client};
    if (uv_pipe_open(&client->pipe, fd) != 0) {
        close(fd);
        client->is_closing = true;
        uv_close((uv_handle_t *)&client->pipe, on_pipe_closed);
        return NULL;
    }
    if (uv_fileno((uv_handle_t *)&client->pipe, &opened) != 0) opened = -1;
    client->groups = client_peer_read(opened, &client->peer, &client->user);
    return client;
}

void client_start(struct client *client)
{
    loop_turns_put(client->host->turns, &client->task);
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

// Reads once a turn of the loop, whatever there is to read: the step begins to read again.
static void on_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buffer)
{
    struct client *client = stream->data;

    if (count == 0) return;
    if (count > 0) {
        message_stream_commit(&client->stream, (size_t)count);
    } else if (count == UV_EOF) {
        client->has_ended = true;
    } else {
        client_close(client);
        return;
    }
    set_reading(client, false);
    loop_turns_put(client->host->turns, &client->task);
}

// Clients of the user that wait for a place may take one in their next steps.
static void give_place(struct client *client)
{
    struct client_account *account = client->outgoing.account;
    struct client *other = client;

    if (!client->has_place) return;
    client->has_place = false;
    client_account_give_place(account);
    while (other->previous)
        other = other->previous;
    for (; other; other = other->next)
        if (other != client && other->outgoing.account == account && !other->is_closing)
            loop_turns_put(other->host->turns, &other->task);
}

void client_change_account(struct client *client, int64_t uid)
{
    struct client_account *before = client->outgoing.account;

    give_place(client);
    outgoing_change_account(&client->outgoing, client_accounts_join(client->host->accounts, uid));
    client_accounts_leave(client->host->accounts, before);
}

static bool may_read(struct client *client)
{
    if (client->has_place || client->stream.end - client->stream.start <= CLIENT_SHORT_LINE) return true;
    client->has_place = client_account_take_place(client->outgoing.account);
    return client->has_place;
}

static bool has_room(const struct client *client)
{
    return !client->is_closing && !client->is_ignored && !client->is_decoding &&
           client->pending_answers < CLIENT_PENDING_LIMIT && client->outgoing.unread_bytes < UNREAD_LIMIT &&
           client->outgoing.account->unread_bytes < USER_UNREAD_LIMIT;
}

static void deliver(struct client *client, struct message *message)
{
    if (message->kind == MESSAGE_REQUEST || message->kind == MESSAGE_NOTIFICATION)
        client->host->on_message(client->host->user, client, message);
    else
        client_send_error(client, message->id[0] ? message->id : no_id, MESSAGE_CODE_INVALID,
                          "expected a request: the daemon sends none");
}

static void refuse_line(struct client *client, const struct message *message, enum message_code code,
                        const struct error *error)
{
    client_send_error(client, message->id[0] ? message->id : no_id, code, error->message);
}

// The line's bytes move to the thread; the few behind it begin a new stream.
static void begin_decode(struct client *client, const char *line, size_t length)
{
    struct long_line *decode = xcalloc(1, sizeof *decode);
    struct message_stream *stream = &client->stream, rest = {.limit_bytes = stream->limit_bytes};

    message_stream_append(&rest, stream->bytes + stream->start, stream->end - stream->start);
    decode->piece = (struct work_piece){.run = on_decode_run, .done = on_decode_done, .uid = client->peer.uid};
    decode->client = client;
    decode->bytes = stream->bytes;
    decode->start = (size_t)(line - stream->bytes);
    decode->length = length;
    *stream = rest;
    client->is_decoding = true;
    client_hold(client, 1);
    work_desk_put(client->host->desk, &decode->piece);
}

static void on_decode_run(struct work_piece *piece)
{
    struct long_line *line = (struct long_line *)piece;

    line->code = MESSAGE_CODE_PARSE;
    line->ok = message_decode(&line->message, line->bytes + line->start, line->length, &line->code, &line->error);
    free(line->bytes);
    line->bytes = NULL;
}

static void on_decode_done(struct work_piece *piece, bool was_run)
{
    struct long_line *line = (struct long_line *)piece;
    struct client *client = line->client;

    client->is_decoding = false;
    give_place(client);
    if (was_run && !line->ok)
        refuse_line(client, &line->message, line->code, &line->error);
    else if (was_run && !client->is_ignored)
        deliver(client, &line->message);
    memory_return_note(client->host->memory, line->length * MEMORY_RETURN_PARSED);
    // What the request has left is freed in a thread as well: it may be a million values.
    line->piece.run = on_discard_run;
    line->piece.done = on_discard_done;
    line->piece.goes_on = true;
    line->client = NULL;
    if (line->message.root)
        work_desk_put(client->host->desk, &line->piece);
    else
        on_discard_done(&line->piece, false);
    client_release(client, 1);
}

static void on_discard_run(struct work_piece *piece)
{
    struct long_line *line = (struct long_line *)piece;

    message_finish(&line->message);
    memory_return_trim(line->length * MEMORY_RETURN_PARSED);
}

static void on_discard_done(struct work_piece *piece, bool was_run)
{
    struct long_line *line = (struct long_line *)piece;

    if (!was_run) message_finish(&line->message);
    free(line->bytes);
    free(line);
}

static void handle_line(struct client *client, const char *line, size_t length)
{
    struct message message = {0};
    enum message_code code = MESSAGE_CODE_PARSE;
    struct error error = {0};

    if (length == 0) return;
    if (length > CLIENT_SHORT_LINE) {
        begin_decode(client, line, length);
        return;
    }
    if (message_decode(&message, line, length, &code, &error))
        deliver(client, &message);
    else
        refuse_line(client, &message, code, &error);
    message_finish(&message);
}

// Sends what is waiting, then closes.
static void end(struct client *client)
{
    set_reading(client, false);
    outgoing_write(&client->outgoing, true);
    client->is_closing = true;
    client->shutdown.data = client;
    if (uv_shutdown(&client->shutdown, (uv_stream_t *)&client->pipe, on_shutdown) != 0)
        on_shutdown(&client->shutdown, 0);
}

// Nothing is left to handle: waits for bytes, or for the answers that are due.
static void wait_for_more(struct client *client)
{
    if (!client->has_ended)
        set_reading(client, may_read(client));
    else if (client->pending_answers == 0)
        end(client);
}

// Sends what waits, then handles one message as far as the limits allow. on_written and client_release put the task
// again.
static bool on_step(struct loop_task *task)
{
    struct client *client = (struct client *)((char *)task - offsetof(struct client, task));
    struct error error = {0};
    const char *line;
    size_t length;

    if (client->is_closing) return false;
    if (!outgoing_write(&client->outgoing, false)) {
        client_close(client);
        return false;
    }
    if (!has_room(client)) return false;
    line = message_stream_next(&client->stream, &length, &error);
    if (line) {
        handle_line(client, line, length);
    } else if (error.message[0]) {
        client_send_error(client, no_id, MESSAGE_CODE_INVALID, error.message);
        end(client);
    } else {
        wait_for_more(client);
    }
    return line && !client->is_closing;
}

void client_refuse(struct client *client, enum message_code code, const char *why)
{
    client_send_error(client, no_id, code, why);
    client_end(client);
}

void client_end(struct client *client)
{
    if (!client->is_closing) end(client);
}

void client_stop_reading(struct client *client)
{
    client->is_ignored = true;
    set_reading(client, false);
}

static void send_text(struct client *client, struct json_writer *writer, bool is_event)
{
    outgoing_add(&client->outgoing, shared_text_create(writer), is_event);
    loop_turns_put(client->host->turns, &client->task);
}

// Of all clients of the same user, the one for which the most bytes of events wait.
static struct client *find_slowest(struct client *client)
{
    const struct client_account *account = client->outgoing.account;
    struct client *slowest = client, *other = client;

    while (other->previous)
        other = other->previous;
    for (; other; other = other->next)
        if (other->outgoing.account == account && other->outgoing.event_bytes > slowest->outgoing.event_bytes)
            slowest = other;
    return slowest;
}

void client_send_event(struct client *client, struct shared_text *event)
{
    struct client *slowest;

    if (client->is_closing) return;
    outgoing_add(&client->outgoing, shared_text_hold(event), true);
    loop_turns_put(client->host->turns, &client->task);
    if (client->outgoing.account->event_bytes <= USER_EVENTS_LIMIT) return;
    slowest = find_slowest(client);
    log_info("a client of %s does not read its events: disconnected", slowest->user);
    client_close(slowest);
}

void client_send_result(struct client *client, const char *id, struct json_writer *value)
{
    struct json_writer writer = {0};

    if (!id[0] || client->is_closing) return;
    message_begin_result(&writer, id);
    if (value->length > SHORT_VALUE) {
        send_text(client, &writer, false);
        send_text(client, value, false);
        writer = (struct json_writer){0};
    } else {
        json_write_raw(&writer, value->text, value->length);
    }
    message_end(&writer);
    send_text(client, &writer, false);
}

void client_send_error(struct client *client, const char *id, enum message_code code, const char *text)
{
    struct json_writer writer = {0};

    if (!id[0] || client->is_closing) return;
    message_write_error(&writer, id, code, text);
    send_text(client, &writer, false);
}

static void on_written(void *user, int status)
{
    struct client *client = user;

    if (client->is_closing) return;
    if (status != 0)
        client_close(client);
    else
        loop_turns_put(client->host->turns, &client->task);
}

static bool has_stalled(struct client *client)
{
    size_t received_bytes = client->stream.end - client->stream.start;
    bool is_same = client->has_place && client->is_reading && received_bytes == client->stalled_bytes;

    client->stalled_checks = is_same ? client->stalled_checks + 1 : 0;
    client->stalled_bytes = received_bytes;
    return client->stalled_checks >= STUCK_CHECKS && client->outgoing.account->long_lines == CLIENT_ACCOUNT_LONG_LINES;
}

void client_check_stuck(struct client *client)
{
    const struct client_account *account = client->outgoing.account;
    size_t queued_bytes = uv_stream_get_write_queue_size((const uv_stream_t *)&client->pipe);

    if (client->is_closing) return;
    client->stuck_checks = queued_bytes > 0 && queued_bytes == client->stuck_bytes ? client->stuck_checks + 1 : 0;
    client->stuck_bytes = queued_bytes;
    if (has_stalled(client)) {
        log_info("a client of %s does not end its message: disconnected", client->user);
        client_close(client);
    } else if (account->unread_bytes < USER_UNREAD_LIMIT) {
        loop_turns_put(client->host->turns, &client->task); // it may have waited for another client of the user
    } else if (client->stuck_checks >= STUCK_CHECKS) {
        log_info("a client of %s does not read its answers: disconnected", client->user);
        client_close(client);
    }
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
    memory_return_note(client->host->memory, client->outgoing.unread_bytes + client->stream.capacity);
    outgoing_drop(&client->outgoing);
    give_place(client);
    loop_turns_remove(client->host->turns, &client->task);
    uv_close((uv_handle_t *)&client->pipe, on_pipe_closed);
}

static void free_if_done(struct client *client)
{
    if (!client->is_closed || client->pending_answers > 0) return;
    message_stream_finish(&client->stream);
    free(client->groups);
    free(client->user);
    free(client);
}

static void on_pipe_closed(uv_handle_t *handle)
{
    struct client *client = handle->data;

    client->is_closed = true;
    if (client->user) client->host->on_closed(client->host->user, client);
    free_if_done(client);
}

void client_hold(struct client *client, size_t answers)
{
    client->pending_answers += answers;
}

// The next message is handled in a later step: it may concern what the caller is still changing.
void client_release(struct client *client, size_t answers)
{
    client->pending_answers -= answers;
    if (client->is_closed)
        free_if_done(client);
    else if (!client->is_closing)
        loop_turns_put(client->host->turns, &client->task);
}
