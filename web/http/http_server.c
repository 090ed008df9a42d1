// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_server.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "web/http/http_connection.h"
#include "web/http/http_connections.h"
#include "web/http/http_credentials.h"
#include "web/http/http_intake.h"
#include "web/http/http_known.h"
#include "web/http/http_listener.h"
#include "web/http/http_socket_events.h"

#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { SWEEP_MS = 500, SOCKET_PIECE = 64 * 1024, PING_S = 30, SILENCE_S = 90, LINGER_TIME_MS = 3000 };

struct http_server {
    struct http_server_params params;
    struct http_listener *listener;      // owned
    struct lws_context *context;         // owned
    struct lws_vhost *vhost;             // the context's
    struct http_connections connections; // owned
    struct http_known *known;            // owned
    struct http_budget *budget;          // owned
    uv_timer_t sweep;
    void *loops[1];
    bool is_closing;
    void (*on_closed)(void *user);
    void *user;
};

static int on_lws(struct lws *wsi, enum lws_callback_reasons reason, void *session, void *bytes, size_t size);
static void tell_if_closed(struct http_server *server);

static const struct lws_protocols protocols[] = {
    {.name = "http", .callback = on_lws, .rx_buffer_size = SOCKET_PIECE},
    {.name = "marchd", .callback = on_lws, .rx_buffer_size = SOCKET_PIECE},
    {0},
};
static const lws_retry_bo_t silence = {.secs_since_valid_ping = PING_S, .secs_since_valid_hangup = SILENCE_S};

void http_connection_wait(struct http_connection *connection, uint64_t time_ms)
{
    connection->deadline_ms = time_ms ? uv_now(connection->server->params.loop) + time_ms : 0;
    if (connection->end_ms && (!time_ms || connection->deadline_ms > connection->end_ms))
        connection->deadline_ms = connection->end_ms;
}

void http_connection_begin_sending(struct http_connection *connection)
{
    const struct http_server_params *params = &connection->server->params;

    connection->end_ms = uv_now(params->loop) + params->send_time_ms;
    http_connection_wait(connection, HTTP_WRITE_TIME_MS);
}

void http_connection_end_sending(struct http_connection *connection)
{
    connection->end_ms = 0;
    http_connection_wait(connection, 0);
}

void http_connection_kill(struct http_connection *connection)
{
    connection->is_leaving = true;
    lws_set_timeout(connection->wsi, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_ASYNC);
    lws_cancel_service(connection->server->context); // it looks at its times after that, else when it has other work
}

static void on_connection(void *user, int fd, const struct http_peer *peer)
{
    struct http_server *server = user;
    struct http_connection *connection;

    if (!http_connections_make_room(&server->connections, peer->place)) {
        log_debug("%s: a connection over the limit is closed", peer->address);
        close(fd);
        return;
    }
    connection = xcalloc(1, sizeof *connection);
    connection->server = server;
    connection->peer = *peer;
    connection->since_ms = uv_now(server->params.loop);
    connection->wsi = lws_adopt_socket_vhost(server->vhost, fd); // closes it where that fails
    if (!connection->wsi) {
        free(connection);
        return;
    }
    lws_set_opaque_user_data(connection->wsi, connection);
    http_connections_add(&server->connections, connection);
    http_connection_assign(connection, NULL);
    http_connection_wait(connection, HTTP_HEAD_TIME_MS);
}

static void forget_connection(struct http_connection *connection)
{
    struct http_server *server = connection->server;

    http_request_destroy(connection->request);
    http_socket_destroy(connection->socket);
    http_hold_end(&connection->hold);
    http_connections_remove(&server->connections, connection);
    free(connection);
    tell_if_closed(server);
}

struct http_known *http_connection_known(const struct http_connection *connection)
{
    return connection->server->known;
}

void http_connection_assign(struct http_connection *connection, const char *user)
{
    connection->is_known = user != NULL;
    http_hold_assign(connection->server->budget, &connection->hold, user ? user : connection->peer.place, user != NULL);
}

static const struct http_route *find_route(const struct http_server *server, const char *method, const char *path,
                                           bool *is_path)
{
    if (strcmp(method, "HEAD") == 0) method = "GET";
    *is_path = false;
    for (const struct http_route *route = server->params.routes; route->path; route++) {
        if (route->is_prefix ? strncmp(path, route->path, strlen(route->path)) != 0 : strcmp(path, route->path) != 0)
            continue;
        *is_path = true;
        if (strcmp(route->method, method) == 0) return route;
    }
    return NULL;
}

static void run_route(struct http_request *request)
{
    request->has_all = true;
    http_connection_wait(request->connection, HTTP_ANSWER_TIME_MS);
    request->route->answer(request, request->route->user);
    free(request->body); // who waits for an answer has copied it
    request->body = NULL;
}

// False: there is no memory for its body.
static bool hold_body(struct http_request *request)
{
    if (request->body_length <= HTTP_SMALL_SIZE) return true;
    if (!http_hold_take(&request->connection->hold, request->body_length + 1)) return false;
    request->held = request->body_length + 1;
    return true;
}

static void refuse(struct http_request *request, int status, const char *text)
{
    request->wants_close = true;
    http_request_fail(request, status, "%s", text);
}

// The head of a request is there.
static int on_head(struct http_connection *connection)
{
    const struct http_server *server = connection->server;
    struct http_request *request;
    struct http_refusal refusal;
    bool is_path;

    // A client that does not wait. libwebsockets has swallowed what it sent, and shows the old head again.
    if (connection->request || connection->is_leaving) return -1;
    lws_set_timeout(connection->wsi, NO_PENDING_TIMEOUT, 0);
    request = connection->request = http_request_create(connection);
    connection->since_ms = uv_now(server->params.loop);
    refusal = http_intake_read(request, connection->wsi, server->params.origins);
    http_connection_assign(connection, http_known_user(server->known, request->token));
    if (!refusal.status) request->route = find_route(server, request->method, request->path, &is_path);
    if (refusal.status)
        refuse(request, refusal.status, refusal.text);
    else if (!request->route)
        refuse(request, is_path ? 405 : 404, is_path ? "this is not asked for so" : "there is no such page");
    else if (request->route->needs_token && !request->token)
        refuse(request, 401, "expected a token or a session's cookie");
    else if (request->body_length > request->route->body_limit)
        refuse(request, 413, "the body is too large");
    else if (!hold_body(request))
        refuse(request, 503, "too much waits here already: try again in a moment");
    else if (request->body_length > 0)
        http_connection_wait(connection, HTTP_BODY_TIME_MS);
    else
        run_route(request);
    return 0;
}

static int on_body(struct http_connection *connection, const char *bytes, size_t size)
{
    struct http_request *request = connection->request;

    if (!request || request->is_answered || request->has_all) return 0;
    if (request->body_size + size > request->body_length) return -1;
    if (!request->body) request->body = xmalloc(request->body_length + 1);
    memcpy(request->body + request->body_size, bytes, size);
    request->body_size += size;
    request->body[request->body_size] = '\0';
    return 0;
}

static int on_body_end(struct http_connection *connection)
{
    struct http_request *request = connection->request;

    if (connection->is_leaving) return -1;
    if (!request || request->is_answered || request->has_all) return 0;
    lws_set_timeout(connection->wsi, NO_PENDING_TIMEOUT, 0);
    run_route(request);
    return 0;
}

// A body that is not read is still to come. To close now would reset the connection, and take the answer away from the
// client: it is told that nothing more comes, and has a moment to read that.
static int linger(struct http_connection *connection)
{
    shutdown(lws_get_socket_fd(connection->wsi), SHUT_WR);
    http_connection_wait(connection, LINGER_TIME_MS);
    return 0;
}

static int on_writable(struct http_connection *connection)
{
    struct http_request *request = connection->request;
    bool wants_close;

    if (!request || !request->is_answered) return 0;
    // The request stays until its answer has left: until then libwebsockets would take what comes for its head again.
    if (request->is_written && lws_partial_buffered(connection->wsi)) {
        lws_callback_on_writable(connection->wsi);
        return 0;
    }
    if (!request->is_written && !http_request_write(request)) return -1;
    if (!request->is_written || lws_partial_buffered(connection->wsi)) {
        lws_callback_on_writable(connection->wsi);
        return 0;
    }
    if (request->body_size < request->body_length) return linger(connection);
    wants_close = request->wants_close;
    http_request_destroy(request);
    connection->request = NULL;
    if (wants_close || lws_http_transaction_completed(connection->wsi)) return -1;
    connection->since_ms = uv_now(connection->server->params.loop);
    http_connection_end_sending(connection);
    http_connection_wait(connection, HTTP_HEAD_TIME_MS);
    return 0;
}

// The head of a request for a WebSocket is there: 0 lets it be one.
static int on_upgrade(struct http_connection *connection, const char *protocol)
{
    const struct http_server *server = connection->server;
    struct http_refusal refusal;

    if (connection->request || connection->is_leaving || strcasecmp(protocol, "websocket") != 0) return -1;
    connection->request = http_request_create(connection);
    refusal = http_intake_read_upgrade(connection->request, connection->wsi, server->params.origins);
    http_connection_assign(connection, http_known_user(server->known, connection->request->token));
    if (!refusal.status) return 0;
    log_debug("%s: no WebSocket: %s", connection->peer.address, refusal.text);
    lws_return_http_status(connection->wsi, (unsigned)refusal.status, refusal.text);
    return -1;
}

static int on_established(struct http_connection *connection)
{
    const struct http_server *server = connection->server;
    struct http_request *request = connection->request;
    int result;

    if (!request || !request->token || connection->socket) return -1;
    connection->socket = http_socket_create(connection, server->params.sockets, server->params.sockets_user);
    result = http_socket_on_established(connection->socket, request->token);
    request->is_answered = true;
    http_request_destroy(request);
    connection->request = NULL;
    return result;
}

static int on_lws(struct lws *wsi, enum lws_callback_reasons reason, void *session, void *bytes, size_t size)
{
    struct http_connection *connection = wsi ? lws_get_opaque_user_data(wsi) : NULL;

    (void)session;
    if (!connection) return 0;
    switch (reason) {
    case LWS_CALLBACK_HTTP:
        return on_head(connection);
    case LWS_CALLBACK_HTTP_BODY:
        return on_body(connection, bytes, size);
    case LWS_CALLBACK_HTTP_BODY_COMPLETION:
        return on_body_end(connection);
    case LWS_CALLBACK_HTTP_WRITEABLE:
        return on_writable(connection);
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
        return on_upgrade(connection, bytes);
    case LWS_CALLBACK_ESTABLISHED:
        return on_established(connection);
    case LWS_CALLBACK_RECEIVE:
        return connection->socket ? http_socket_on_receive(connection->socket, bytes, size) : -1;
    case LWS_CALLBACK_SERVER_WRITEABLE:
        return connection->socket ? http_socket_on_writable(connection->socket) : -1;
    case LWS_CALLBACK_RAW_ADOPT: // CONNECT, which libwebsockets would make a plain stream
    case LWS_CALLBACK_RAW_CONNECTED:
    case LWS_CALLBACK_RAW_RX:
        return -1;
    case LWS_CALLBACK_WSI_DESTROY:
        lws_set_opaque_user_data(wsi, NULL);
        forget_connection(connection);
        return 0;
    default:
        return 0;
    }
}

// libwebsockets reads nothing while an answer is awaited, and so does not see that nobody waits for it any more.
static bool is_deserted(const struct http_connection *connection)
{
    const struct http_request *request = connection->request;
    char byte;

    return request && request->has_all && !request->is_answered &&
           recv(lws_get_socket_fd(connection->wsi), &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
}

static void on_sweep(uv_timer_t *timer)
{
    struct http_server *server = timer->data;
    uint64_t now = uv_now(server->params.loop);

    for (struct http_connection *at = server->connections.first; at; at = at->next) {
        if ((!at->deadline_ms || at->deadline_ms > now) && !is_deserted(at)) continue;
        log_debug("%s: a connection ends: %s", at->peer.address,
                  at->end_ms && at->end_ms <= now ? "its answer was not taken in time" : "it was silent");
        at->deadline_ms = 0;
        http_connection_kill(at);
    }
}

static void on_lws_error(int level, const char *line)
{
    (void)level;
    log_warn("libwebsockets: %s", line);
}

// What it says of strangers' requests would fill the log.
static void on_lws_complaint(int level, const char *line)
{
    (void)level;
    log_debug("libwebsockets: %s", line);
}

// Its own log says no more than errors: what it parses holds tokens.
static bool open_context(struct http_server *server, struct error *error)
{
    struct lws_context_creation_info info = {
        .port = CONTEXT_PORT_NO_LISTEN_SERVER,
        .protocols = protocols,
        .options = LWS_SERVER_OPTION_LIBUV | LWS_SERVER_OPTION_VALIDATE_UTF8 | LWS_SERVER_OPTION_EXPLICIT_VHOSTS,
        .foreign_loops = server->loops,
        .count_threads = 1,
        .max_http_header_data = HTTP_HEAD_LIMIT,
        .max_http_header_pool = (unsigned short)server->params.connection_limit,
        .fd_limit_per_thread = (unsigned)server->params.connection_limit + HTTP_SPARE_CONNECTIONS,
        .pt_serv_buf_size = SOCKET_PIECE,
        .timeout_secs = HTTP_BODY_TIME_MS / 1000,
        .keepalive_timeout = HTTP_HEAD_TIME_MS / 1000,
        .retry_and_idle_policy = &silence,
        .gid = (gid_t)-1,
        .uid = (uid_t)-1,
        .user = server,
    };

    lws_set_log_level(LLL_ERR, on_lws_error);
    server->loops[0] = server->params.loop;
    server->context = lws_create_context(&info);
    server->vhost = server->context ? lws_create_vhost(server->context, &info) : NULL;
    lws_set_log_level(LLL_ERR, on_lws_complaint);
    if (server->vhost) return true;
    error_set(error, "libwebsockets does not start (is its plugin for libuv installed?)");
    return false;
}

struct http_server *http_server_open(const struct http_server_params *params, struct error *error)
{
    struct http_server *server = xcalloc(1, sizeof *server);
    struct http_listener_params listener = {
        .loop = params->loop, .address = params->address, .on_connection = on_connection, .user = server};

    server->params = *params;
    server->known = http_known_create();
    server->budget = http_budget_create(params->buffer_bytes);
    server->connections.limit = params->connection_limit;
    server->connections.place_limit = params->address_limit;
    server->listener = http_listener_open(&listener, error);
    if (!server->listener || !open_context(server, error)) {
        http_listener_close(server->listener);
        http_known_destroy(server->known);
        http_budget_destroy(server->budget);
        free(server);
        return NULL;
    }
    uv_timer_init(params->loop, &server->sweep);
    server->sweep.data = server;
    uv_timer_start(&server->sweep, on_sweep, SWEEP_MS, SWEEP_MS);
    return server;
}

int http_server_port(const struct http_server *server)
{
    return http_listener_port(server->listener);
}

static void tell_if_closed(struct http_server *server)
{
    if (!server->is_closing || server->connections.first || uv_is_closing((uv_handle_t *)&server->sweep)) return;
    uv_close((uv_handle_t *)&server->sweep, NULL);
    server->on_closed(server->user);
}

void http_server_close(struct http_server *server, void (*on_closed)(void *user), void *user)
{
    server->on_closed = on_closed;
    server->user = user;
    server->is_closing = true;
    http_listener_close(server->listener);
    lws_context_destroy(server->context);
    tell_if_closed(server);
}

void http_server_destroy(struct http_server *server)
{
    if (!server) return;
    lws_context_destroy(server->context);
    http_known_destroy(server->known);
    http_budget_destroy(server->budget);
    free(server);
}
