// SPDX-License-Identifier: Apache-2.0
#include "web/program/web.h"

#include "core/base/error.h"
#include "core/base/log.h"
#include "core/wire/message_stream.h"
#include "web/farm/farm_calls.h"
#include "web/http/http_server.h"
#include "web/http/http_walls.h"
#include "web/notify/notifier.h"
#include "web/program/web_check.h"
#include "web/routes/route_files.h"
#include "web/routes/route_frame.h"
#include "web/routes/route_metrics.h"
#include "web/routes/route_ready.h"
#include "web/routes/route_rpc.h"
#include "web/routes/route_session.h"
#include "web/routes/route_socket.h"
#include "web/settings/web_options.h"

#include <signal.h>
#include <systemd/sd-daemon.h>
#include <uv.h>

enum { ROUTE_COUNT = 16 };

struct web {
    uv_loop_t loop;
    uv_signal_t terminated, interrupted;
    struct http_origins origins;
    struct http_server *server; // owned
    bool is_ending;
    struct farm_calls *calls;
    struct route_frame *frames;
    struct notifier *notifier;
    struct route_files files;
    struct route_session session;
    struct route_ready *ready; // owned
    struct route_socket sockets;
    struct http_route routes[ROUTE_COUNT];
};

static void on_signal(uv_signal_t *handle, int number);

static void answer_health(struct http_request *request, void *user)
{
    (void)user;
    http_request_answer(request,
                        &(struct http_answer){.type = "text/plain; charset=utf-8", .bytes = "ok\n", .size_bytes = 3});
}

static void lay_out(struct web *web, const struct web_options *options)
{
    const struct http_route routes[ROUTE_COUNT] = {
        {.method = "GET", .path = "/", .answer = route_session_front, .user = &web->session},
        {.method = "GET", .path = "/page/", .is_prefix = true, .answer = route_files_page, .user = &web->files},
        {.method = "GET", .path = "/vendor/chart.js", .answer = route_files_chart, .user = &web->files},
        {.method = "GET", .path = "/openrpc.json", .answer = route_files_document, .user = &web->files},
        {.method = "GET", .path = "/schema.json", .answer = route_files_document, .user = &web->files},
        {.method = "GET", .path = "/healthz", .answer = answer_health},
        {.method = "GET", .path = "/readyz", .answer = route_ready_answer, .user = web->ready},
        {.method = "GET", .path = "/metrics", .needs_token = true, .answer = route_metrics, .user = web->calls},
        {.method = "GET", .path = "/session", .needs_token = true, .answer = route_session_show, .user = &web->session},
        {.method = "GET",
         .path = "/frame/",
         .is_prefix = true,
         .needs_token = true,
         .answer = route_frame_answer,
         .user = web->frames},
        {.method = "GET",
         .path = "/job/",
         .is_prefix = true,
         .needs_token = true,
         .answer = route_frame_answer,
         .user = web->frames},
        {.method = "POST", .path = "/logout", .answer = route_session_end, .user = &web->session},
        {.method = "POST",
         .path = "/rpc",
         .needs_token = true,
         .body_limit = MESSAGE_LINE_LIMIT,
         .answer = route_rpc,
         .user = web->calls},
    };

    web->files = (struct route_files){.page_folder = options->page_folder,
                                      .document_folder = options->document_folder,
                                      .chart_file = options->chart_file};
    web->session = (struct route_session){.calls = web->calls, .files = &web->files};
    web->sockets = (struct route_socket){.loop = &web->loop, .socket_path = options->socket_path};
    for (int i = 0; i < ROUTE_COUNT; i++)
        web->routes[i] = routes[i];
}

static struct route_frame *open_frames(struct web *web, const struct web_options *options)
{
    return route_frame_open(&(struct route_frame_params){.loop = &web->loop,
                                                         .calls = web->calls,
                                                         .worker = options->worker_program,
                                                         .cache_folder = options->cache_folder,
                                                         .cache_bytes = options->cache_bytes,
                                                         .worker_bytes = options->picture_memory_bytes,
                                                         .limit_ms = options->picture_time_ms,
                                                         .worker_count = options->picture_workers});
}

static void watch_signal(struct web *web, uv_signal_t *handle, int number)
{
    uv_signal_init(&web->loop, handle);
    handle->data = web;
    uv_signal_start(handle, on_signal, number);
}

// No request is left that could call the daemon.
static void on_server_closed(void *user)
{
    struct web *web = user;

    route_ready_destroy(web->ready);
    route_frame_close(web->frames);
    farm_calls_destroy(web->calls);
}

static void stop(struct web *web)
{
    web->is_ending = true;
    if (web->server)
        http_server_close(web->server, on_server_closed, web);
    else
        on_server_closed(web);
    uv_close((uv_handle_t *)&web->terminated, NULL);
    uv_close((uv_handle_t *)&web->interrupted, NULL);
}

static void on_signal(uv_signal_t *handle, int number)
{
    struct web *web = handle->data;

    if (web->is_ending) return;
    log_info("ends: signal %d", number);
    sd_notify(0, "STOPPING=1");
    stop(web);
}

// Where the settings name nobody who could be told, notices stay with the daemon.
static bool start_notifier(struct web *web, const struct web_options *options, struct error *error)
{
    const struct notifier_params params = {.socket_path = options->socket_path,
                                           .targets = &options->notify_targets,
                                           .allows_webhooks = options->notify_webhooks,
                                           .timeout_ms = options->notify_timeout_ms,
                                           .keep_ms = options->notify_keep_ms};

    if (options->notify_targets.count == 0 && !options->notify_webhooks) return true;
    web->notifier = notifier_start(&params, error);
    return web->notifier;
}

static void announce(const struct web *web, const struct web_options *options)
{
    log_info("listens at %s (port %d), for the daemon at %s", options->listen, http_server_port(web->server),
             options->socket_path);
    sd_notify(0, "READY=1");
}

bool web_run(const struct web_options *options, struct error *error)
{
    struct web web = {0};
    struct http_server_params params = {.loop = &web.loop,
                                        .address = options->listen,
                                        .origins = &web.origins,
                                        .routes = web.routes,
                                        .sockets = &route_socket_handlers,
                                        .sockets_user = &web.sockets,
                                        .connection_limit = (size_t)options->connection_limit,
                                        .address_limit = (size_t)options->address_limit,
                                        .buffer_bytes = (size_t)options->buffer_bytes,
                                        .send_time_ms = (uint64_t)options->send_time_ms};
    bool is_begun;

    signal(SIGPIPE, SIG_IGN);
    uv_loop_init(&web.loop);
    web.calls = farm_calls_create(&web.loop, options->socket_path);
    web.ready = route_ready_create(&web.loop, web.calls);
    web.frames = open_frames(&web, options);
    lay_out(&web, options);
    watch_signal(&web, &web.terminated, SIGTERM);
    watch_signal(&web, &web.interrupted, SIGINT);
    if (web_check_options(options, &web.origins, error)) web.server = http_server_open(&params, error);
    is_begun = web.server && start_notifier(&web, options, error);
    if (is_begun)
        announce(&web, options);
    else
        stop(&web);
    uv_run(&web.loop, UV_RUN_DEFAULT);
    notifier_stop(web.notifier);
    http_server_destroy(web.server);
    uv_loop_close(&web.loop);
    http_origins_finish(&web.origins);
    return is_begun;
}
