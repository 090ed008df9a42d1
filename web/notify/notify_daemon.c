// SPDX-License-Identifier: Apache-2.0
#include "web/notify/notify_daemon.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "core/wire/message_stream.h"
#include "web/notify/notify_queue.h"
#include "web/notify/notify_target.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

enum { CALL_MS = 60 * 1000, NOTICES_OF_A_CALL = 200 };
static const int64_t ID_MAX = (INT64_C(1) << 53) - 1;

struct notify_daemon {
    const char *socket_path; // borrowed
    int stop_fd;
    int fd; // -1: no connection
    struct message_stream stream;
    int64_t last_call;
    int64_t after; // id of the last notice that is known
    bool is_told;  // it knows whom jobs may name
};

struct notify_daemon *notify_daemon_create(const char *socket_path, int stop_fd)
{
    struct notify_daemon *daemon = xcalloc(1, sizeof *daemon);

    daemon->socket_path = socket_path;
    daemon->stop_fd = stop_fd;
    daemon->fd = -1;
    return daemon;
}

static void disconnect(struct notify_daemon *daemon)
{
    if (daemon->fd >= 0) close(daemon->fd);
    daemon->fd = -1;
    daemon->is_told = false;
    message_stream_finish(&daemon->stream);
    daemon->stream = (struct message_stream){0};
}

void notify_daemon_destroy(struct notify_daemon *daemon)
{
    if (!daemon) return;
    disconnect(daemon);
    free(daemon);
}

static bool connect_to(struct notify_daemon *daemon, struct error *error)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};

    if (daemon->fd >= 0) return true;
    if (strlen(daemon->socket_path) >= sizeof address.sun_path) {
        error_set(error, "%s: the path is too long", daemon->socket_path);
        return false;
    }
    strcpy(address.sun_path, daemon->socket_path);
    daemon->fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (daemon->fd >= 0 && connect(daemon->fd, (struct sockaddr *)&address, sizeof address) == 0) return true;
    error_set_errno(error, errno, "%s: the daemon is away", daemon->socket_path);
    disconnect(daemon);
    return false;
}

static bool read_more(struct notify_daemon *daemon, struct error *error)
{
    struct pollfd polled[2] = {{.fd = daemon->fd, .events = POLLIN}, {.fd = daemon->stop_fd, .events = POLLIN}};
    int ready = poll(polled, 2, CALL_MS);
    ssize_t count;
    size_t room;
    char *bytes;

    if (ready < 0 && errno == EINTR) return true;
    if (ready <= 0 || polled[1].revents) {
        error_set(error, ready == 0 ? "the daemon does not answer" : "march-web ends");
        return false;
    }
    bytes = message_stream_reserve(&daemon->stream, &room);
    count = recv(daemon->fd, bytes, room, MSG_DONTWAIT);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) return true;
    if (count <= 0) {
        error_set(error, "the daemon has closed the connection");
        return false;
    }
    message_stream_commit(&daemon->stream, (size_t)count);
    return true;
}

static bool await_answer(struct notify_daemon *daemon, struct message *reply, struct error *error)
{
    for (;;) {
        struct error fault = {0};
        enum message_code code;
        size_t length;
        const char *line = message_stream_next(&daemon->stream, &length, &fault);

        if (line && message_decode(reply, line, length, &code, &fault)) return true;
        if (fault.message[0]) {
            error_set(error, "the daemon sent what is no message: %s", fault.message);
            return false;
        }
        if (!read_more(daemon, error)) return false;
    }
}

static bool send_all(struct notify_daemon *daemon, const struct json_writer *line, struct error *error)
{
    for (size_t sent = 0; sent < line->length;) {
        ssize_t count = send(daemon->fd, line->text + sent, line->length - sent, MSG_NOSIGNAL);

        if (count < 0 && errno == EINTR) continue;
        if (count < 0) {
            error_set_errno(error, errno, "the daemon takes no messages");
            return false;
        }
        sent += (size_t)count;
    }
    return true;
}

// A connection whose call failed is no longer used.
static bool call(struct notify_daemon *daemon, const char *method, const struct json_writer *params,
                 struct message *reply, struct error *error)
{
    struct json_writer line = {0};
    char id[24];
    bool ok;

    if (!connect_to(daemon, error)) return false;
    message_begin_request(&line, ++daemon->last_call, method);
    json_write_raw(&line, params->text, params->length);
    message_end(&line);
    snprintf(id, sizeof id, "%" PRId64, daemon->last_call);
    ok = send_all(daemon, &line, error) && await_answer(daemon, reply, error);
    json_writer_finish(&line);
    if (!ok) {
        disconnect(daemon);
        return false;
    }
    if (reply->kind == MESSAGE_RESULT && strcmp(reply->id, id) == 0) return true;
    error_set(error, "%s: %s", method, reply->kind == MESSAGE_ERROR && reply->text ? reply->text : "not its answer");
    message_finish(reply);
    disconnect(daemon);
    return false;
}

static void write_targets(const struct notify_targets *targets, bool allows_webhooks, struct json_writer *params)
{
    json_write_key(params, "targets");
    json_write_begin_array(params);
    for (size_t i = 0; i < targets->count; i++)
        json_write_string(params, targets->targets[i].name);
    json_write_end_array(params);
    json_write_bool_member(params, "webhooks", allows_webhooks);
}

// One notice of the answer; the order of ids is that of events.
static bool read_notice(struct notify_daemon *daemon, const struct json_node *node, struct notify_queue *queue,
                        struct error *error)
{
    struct json_node id = json_node_child(node, "id"), owner = json_node_child(node, "owner_uid"),
                     made = json_node_child(node, "made"), event = json_node_child(node, "event"),
                     to = json_node_child(node, "to"), webhook = json_node_child(node, "webhook"),
                     body = json_node_child(node, "body");
    bool is_webhook = json_node_type(&webhook) == JSON_STRING;
    const char *target, *event_text, *body_text;
    struct notify_item item = {0};
    double made_s;

    if (!json_read_integer(&id, 1, ID_MAX, &item.id, error) ||
        !json_read_integer(&owner, -ID_MAX, ID_MAX, &item.owner_uid, error) ||
        !json_read_number(&made, 0, 1e12, &made_s, error) || !json_read_string(&event, &event_text, error) ||
        !json_read_string(&body, &body_text, error) || !json_read_string(is_webhook ? &webhook : &to, &target, error))
        return false;
    if (item.id <= daemon->after) return true;
    daemon->after = item.id;
    item.made_ms = (int64_t)(made_s * 1000);
    item.event = xstrdup(event_text);
    item.body = xstrdup(body_text);
    notify_queue_add(queue, target, is_webhook, &item);
    return true;
}

static bool read_notices(struct notify_daemon *daemon, const struct json_node *result, struct notify_queue *queue,
                         bool *is_all, struct error *error)
{
    struct json_node notices = json_node_child(result, "notices"), notice = {0};

    if (!json_check_array(&notices, 0, NOTICES_OF_A_CALL, error)) return false;
    *is_all = json_node_count(&notices) == 0;
    while (json_node_next(&notices, &notice))
        if (!read_notice(daemon, &notice, queue, error)) return false;
    return true;
}

bool notify_daemon_ask(struct notify_daemon *daemon, const struct notify_targets *targets, bool allows_webhooks,
                       struct notify_queue *queue, bool *is_all, struct error *error)
{
    struct json_writer params = {0};
    struct message reply;
    bool ok, all = true;

    if (!connect_to(daemon, error)) return false;
    json_write_begin_object(&params);
    json_write_integer_member(&params, "after", daemon->after);
    json_write_integer_member(&params, "limit", NOTICES_OF_A_CALL);
    if (!daemon->is_told) write_targets(targets, allows_webhooks, &params);
    json_write_end_object(&params);
    ok = call(daemon, "notify.pending", &params, &reply, error);
    json_writer_finish(&params);
    if (!ok) return false;
    daemon->is_told = true;
    ok = read_notices(daemon, &reply.body, queue, &all, error);
    message_finish(&reply);
    if (!ok) disconnect(daemon);
    if (is_all) *is_all = all;
    return ok;
}

bool notify_daemon_tell(struct notify_daemon *daemon, int64_t id, const char *why, struct error *error)
{
    struct json_writer params = {0};
    struct message reply;
    bool ok;

    json_write_begin_object(&params);
    json_write_integer_member(&params, "id", id);
    if (why) json_write_string_member(&params, "error", why);
    json_write_end_object(&params);
    ok = call(daemon, "notify.done", &params, &reply, error);
    json_writer_finish(&params);
    if (ok) message_finish(&reply);
    return ok;
}
