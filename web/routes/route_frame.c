// SPDX-License-Identifier: Apache-2.0
#include "web/routes/route_frame.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/hash.h"
#include "core/base/log.h"
#include "core/base/path_list.h"
#include "core/wire/message.h"
#include "web/http/http_request.h"
#include "web/pictures/explanation.h"
#include "web/pictures/picture_query.h"
#include "web/pictures/pictures.h"
#include "web/routes/web_calls.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { ROOTS_TIME_MS = 10000, PAIR_LIMIT = 16, EXPIRE_MS = 500 };

struct route_frame {
    struct farm_calls *calls;  // borrowed
    uv_async_t answers;        // a thread has some
    uv_timer_t expiry;         // disks are not waited for without end
    struct pictures *pictures; // owned; NULL: there can be none
    struct error error;        // why
    struct path_list roots;    // below which the farm's pictures are, as the daemon said last
    struct path_list inputs;   // and below which jobs read
    uint64_t roots_until_ms;
};

// A request that waits for its picture.
struct showing {
    struct route_frame *route; // borrowed
    struct http_request *request;
    struct picture_ask *ask;
};

static void on_roots(struct http_request *request, const struct farm_answer *answer, void *user);
static void on_frame(struct http_request *request, const struct farm_answer *answer, void *user);
static void on_job(struct http_request *request, const struct farm_answer *answer, void *user);
static void on_answers(uv_async_t *handle);
static void on_expiry(uv_timer_t *timer);

static void wake_loop(void *user)
{
    uv_async_send(user);
}

static bool make_folder(const char *folder, struct error *error)
{
    if (mkdir(folder, 0700) == 0 || errno == EEXIST) return true;
    error_set_errno(error, errno, "%s", folder);
    return false;
}

struct route_frame *route_frame_open(const struct route_frame_params *params)
{
    struct route_frame *route = xcalloc(1, sizeof *route);
    const struct pictures_params pictures = {.worker = params->worker,
                                             .cache_folder = params->cache_folder,
                                             .cache_bytes = (uint64_t)params->cache_bytes,
                                             .worker_bytes = params->worker_bytes,
                                             .limit_ms = (int)params->limit_ms,
                                             .maker_count = params->worker_count,
                                             .on_answers = wake_loop,
                                             .user = &route->answers};

    route->calls = params->calls;
    uv_async_init(params->loop, &route->answers, on_answers);
    route->answers.data = route;
    uv_timer_init(params->loop, &route->expiry);
    route->expiry.data = route;
    if (make_folder(params->cache_folder, &route->error)) route->pictures = pictures_create(&pictures, &route->error);
    if (!route->pictures) log_warn("there are no pictures of frames: %s", route->error.message);
    return route;
}

static void on_expiry(uv_timer_t *timer)
{
    struct route_frame *route = timer->data;

    if (!pictures_expire(route->pictures)) uv_timer_stop(timer);
}

static void on_closed(uv_handle_t *handle)
{
    free(handle->data);
}

static void on_expiry_closed(uv_handle_t *handle)
{
    struct route_frame *route = handle->data;

    uv_close((uv_handle_t *)&route->answers, on_closed);
}

void route_frame_close(struct route_frame *route)
{
    if (route->pictures) pictures_destroy(route->pictures);
    path_list_finish(&route->roots);
    path_list_finish(&route->inputs);
    uv_close((uv_handle_t *)&route->expiry, on_expiry_closed);
}

// Reads what is asked for. False: the request was answered with what is wrong.
static bool read_query(struct http_request *request, struct picture_query *query)
{
    size_t count = http_request_query_count(request);
    const char *pairs[PAIR_LIMIT];
    struct error error = {0};

    if (count > PAIR_LIMIT) count = PAIR_LIMIT;
    for (size_t i = 0; i < count; i++)
        pairs[i] = http_request_query_at(request, i);
    if (picture_query_parse(query, http_request_path(request), pairs, count, &error)) return true;
    http_request_fail(request, 400, "%s", error.message);
    return false;
}

static int find_status(const struct message *message)
{
    if (message->kind != MESSAGE_ERROR) return 502;
    switch (message->code) {
    case MESSAGE_CODE_NOT_FOUND:
        return 404;
    case MESSAGE_CODE_NOT_ALLOWED:
        return 403;
    case MESSAGE_CODE_PARAMS:
        return 400;
    default:
        return 502;
    }
}

// Reads the daemon's answer. False: the request was answered with what is wrong.
static bool read_answer(struct http_request *request, const struct farm_answer *answer, struct message *message)
{
    struct error error = {0};
    enum message_code code;

    if (!message_decode(message, answer->line, answer->length, &code, &error)) {
        http_request_fail(request, 502, "the daemon: %s", error.message);
        return false;
    }
    if (message->kind == MESSAGE_RESULT) return true;
    http_request_fail(request, find_status(message), "%s",
                      message->kind == MESSAGE_ERROR ? message->text : "the daemon gave no answer");
    message_finish(message);
    return false;
}

static void call_daemon(struct route_frame *route, struct http_request *request, const char *text,
                        web_on_answer *on_answer)
{
    web_calls_begin(route->calls, request, text, strlen(text), on_answer, route);
}

// Which file the frame has, or what the job's document is.
static void ask_subject(struct route_frame *route, struct http_request *request)
{
    struct picture_query query;
    char text[256];

    if (!read_query(request, &query)) return;
    if (query.form == PICTURE_FORM_EXPLANATION) {
        snprintf(text, sizeof text,
                 "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"job.show\",\"params\":{\"id\":%" PRId64 "}}", query.job);
        call_daemon(route, request, text, on_job);
        return;
    }
    snprintf(text, sizeof text,
             "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"job.frames\",\"params\":{\"id\":%" PRId64
             ",\"range\":\"%" PRId32 "\",\"limit\":1}}",
             query.job, query.frame);
    call_daemon(route, request, text, on_frame);
}

void route_frame_answer(struct http_request *request, void *user)
{
    struct route_frame *route = user;
    struct picture_query query;

    if (!read_query(request, &query)) return;
    if (!route->pictures)
        http_request_fail(request, 503, "there are no pictures of frames: %s", route->error.message);
    else if (uv_now(route->answers.loop) < route->roots_until_ms)
        ask_subject(route, request);
    else
        call_daemon(route, request, "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"daemon.status\"}", on_roots);
}

// The roots of the settings, and those of jobs.
static void take_roots(struct route_frame *route, const struct message *message)
{
    struct json_node roots = json_node_child(&message->body, "roots"), root = {0};
    struct json_node inputs = json_node_child(&message->body, "input_roots"), input = {0};
    const char *text;

    path_list_finish(&route->roots);
    while (json_node_next(&roots, &root)) {
        struct json_node path = json_node_child(&root, "path");

        if (json_read_string(&path, &text, NULL) && text[0] == '/') path_list_add(&route->roots, xstrdup(text));
    }
    path_list_finish(&route->inputs);
    while (json_node_next(&inputs, &input))
        if (json_read_string(&input, &text, NULL) && text[0] == '/') path_list_add(&route->inputs, xstrdup(text));
    route->roots_until_ms = uv_now(route->answers.loop) + ROOTS_TIME_MS;
}

static void on_roots(struct http_request *request, const struct farm_answer *answer, void *user)
{
    struct route_frame *route = user;
    struct message message;

    if (!read_answer(request, answer, &message)) return;
    take_roots(route, &message);
    message_finish(&message);
    ask_subject(route, request);
}

static void on_gone(void *user)
{
    struct showing *showing = user;

    pictures_drop(showing->route->pictures, showing->ask);
    log_debug("a picture is not waited for any more");
    free(showing);
}

// `subject` as in struct picture_question.
static void ask_picture(struct route_frame *route, struct http_request *request, const char *subject, const char *user)
{
    struct showing *showing;
    struct picture_query query;
    struct picture_question question = {.query = &query,
                                        .subject = subject,
                                        .user = (int64_t)hash_bytes_short(user, strlen(user), 0),
                                        .known = http_request_known_etag(request)};

    if (!read_query(request, &query)) return;
    question.roots = query.form == PICTURE_FORM_EXPLANATION ? &route->inputs : &route->roots;
    showing = xcalloc(1, sizeof *showing);
    *showing = (struct showing){.route = route, .request = request};
    showing->ask = pictures_ask(route->pictures, &question, showing);
    http_request_on_gone(request, on_gone, showing);
    if (!uv_is_active((uv_handle_t *)&route->expiry)) uv_timer_start(&route->expiry, on_expiry, EXPIRE_MS, EXPIRE_MS);
    log_debug("%s: a picture of %s", http_request_address(request), http_request_path(request));
}

static void on_frame(struct http_request *request, const struct farm_answer *answer, void *user)
{
    struct json_node frames, frame, path, state;
    const char *file, *name = "unknown";
    struct message message;

    if (!read_answer(request, answer, &message)) return;
    frames = json_node_child(&message.body, "frames");
    frame = json_node_element(&frames, 0);
    path = json_node_child(&frame, "path");
    state = json_node_child(&frame, "state");
    if (json_node_is_absent(&frame)) {
        http_request_fail(request, 404, "the job has no such frame");
    } else if (json_node_type(&path) == JSON_STRING && json_read_string(&path, &file, NULL)) {
        ask_picture(user, request, file, answer->identity->user);
    } else {
        (void)json_read_string(&state, &name, NULL);
        http_request_fail(request, 404, "the frame has no file yet: it is %s", name);
    }
    message_finish(&message);
}

static void on_job(struct http_request *request, const struct farm_answer *answer, void *user)
{
    struct json_node document;
    struct message message;
    char *text = NULL;

    if (!read_answer(request, answer, &message)) return;
    document = json_node_child(&message.body, "document");
    if (json_node_type(&document) == JSON_OBJECT) text = json_node_format(&document);
    message_finish(&message);
    if (!text)
        http_request_fail(request, 403, "only its owner and administrators may read a job's document");
    else if (strlen(text) > EXPLANATION_DOCUMENT_LIMIT)
        http_request_fail(request, 413, "the document has more than %d bytes: march explain reads it",
                          EXPLANATION_DOCUMENT_LIMIT);
    else
        ask_picture(user, request, text, answer->identity->user);
    free(text);
}

static void show(struct http_request *request, const struct picture_answer *answer)
{
    const char *dot = strrchr(http_request_path(request), '.');
    bool is_picture = dot && !strcmp(dot, ".png");
    struct picture_file *file = answer->file;
    struct http_answer shown = {
        .type = is_picture ? "image/png" : "application/json", .etag = answer->key, .cache = "private, no-cache"};

    if (answer->reason) {
        http_request_fail(request, (int)answer->status, "%s", answer->reason);
        return;
    }
    shown.status = (int)answer->status;
    if (answer->status == PICTURE_READY) {
        shown.picture = is_picture ? file->facts : NULL;
        shown.has_file = true;
        shown.file_fd = file->fd;
        shown.size_bytes = (size_t)file->body_bytes;
        file->fd = -1;
    }
    http_request_answer(request, &shown);
}

static void on_answers(uv_async_t *handle)
{
    struct route_frame *route = handle->data;
    struct picture_ask *ask;

    while ((ask = pictures_take_answer(route->pictures))) {
        struct showing *showing = picture_ask_user(ask);
        struct picture_answer answer = picture_ask_answer(ask);

        http_request_on_gone(showing->request, NULL, NULL);
        show(showing->request, &answer);
        free(showing);
        picture_ask_free(ask);
    }
}
