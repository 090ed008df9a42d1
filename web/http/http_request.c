// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_request.h"

#include "core/base/alloc.h"
#include "core/base/log.h"
#include "core/json/json_write.h"
#include "web/http/http_connection.h"
#include "web/http/http_credentials.h"
#include "web/http/http_known.h"
#include "web/http/http_walls.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PIECE = 64 * 1024 }; // bytes written at once

// No script, style or picture but our own files; nobody may frame us; nothing of ours is for other sites.
static const char walls[] = "Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; "
                            "img-src 'self' blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
                            "frame-ancestors 'none'\r\n"
                            "X-Content-Type-Options: nosniff\r\n"
                            "X-Frame-Options: DENY\r\n"
                            "Referrer-Policy: no-referrer\r\n"
                            "Cross-Origin-Opener-Policy: same-origin\r\n"
                            "Cross-Origin-Resource-Policy: same-origin\r\n";

struct http_request *http_request_create(struct http_connection *connection)
{
    struct http_request *request = xcalloc(1, sizeof *request);

    request->connection = connection;
    return request;
}

void http_request_destroy(struct http_request *request)
{
    if (!request) return;
    if (!request->is_answered && request->on_gone) request->on_gone(request->user);
    for (size_t i = 0; i < request->query_count; i++)
        http_credentials_free(request->queries[i]);
    http_credentials_free(request->token);
    free(request->path);
    free(request->host);
    free(request->origin);
    free(request->fetch_site);
    free(request->known_etag);
    free(request->body);
    if (request->has_file) close(request->file_fd);
    free(request->head);
    free(request->content);
    http_hold_give(&request->connection->hold, request->held);
    free(request);
}

const char *http_request_path(const struct http_request *request)
{
    return request->path;
}

const char *http_request_query(const struct http_request *request, const char *name)
{
    size_t length = strlen(name);

    for (size_t i = 0; i < request->query_count; i++)
        if (strncmp(request->queries[i], name, length) == 0 && request->queries[i][length] == '=')
            return request->queries[i] + length + 1;
    return NULL;
}

size_t http_request_query_count(const struct http_request *request)
{
    return request->query_count;
}

const char *http_request_query_at(const struct http_request *request, size_t index)
{
    return request->queries[index];
}

const char *http_request_token(const struct http_request *request)
{
    return request->token;
}

const char *http_request_known_etag(const struct http_request *request)
{
    return request->known_etag;
}

const char *http_request_body(const struct http_request *request, size_t *size_bytes)
{
    *size_bytes = request->body_size;
    return request->body ? request->body : "";
}

const char *http_request_address(const struct http_request *request)
{
    return request->connection->peer.address;
}

bool http_request_is_head(const struct http_request *request)
{
    return strcmp(request->method, "HEAD") == 0;
}

bool http_request_is_secure(const struct http_request *request)
{
    return request->is_secure;
}

bool http_request_is_from_elsewhere(const struct http_request *request)
{
    return !http_fetch_is_ours(request->fetch_site);
}

void http_request_set_user(struct http_request *request, const char *user)
{
    struct http_known *known = http_connection_known(request->connection);

    if (!request->token) return;
    if (user)
        http_known_add(known, request->token, user);
    else
        http_known_drop(known, request->token);
    http_connection_assign(request->connection, user);
}

void http_request_on_gone(struct http_request *request, void (*on_gone)(void *user), void *user)
{
    request->on_gone = on_gone;
    request->user = user;
}

static const char *status_text(int status)
{
    static const struct {
        int status;
        const char *text;
    } texts[] = {{200, "OK"},
                 {204, "No Content"},
                 {303, "See Other"},
                 {304, "Not Modified"},
                 {400, "Bad Request"},
                 {401, "Unauthorized"},
                 {403, "Forbidden"},
                 {404, "Not Found"},
                 {405, "Method Not Allowed"},
                 {409, "Conflict"},
                 {411, "Length Required"},
                 {413, "Content Too Large"},
                 {415, "Unsupported Media Type"},
                 {421, "Misdirected Request"},
                 {422, "Unprocessable Content"},
                 {429, "Too Many Requests"},
                 {500, "Internal Server Error"},
                 {501, "Not Implemented"},
                 {502, "Bad Gateway"},
                 {503, "Service Unavailable"},
                 {504, "Gateway Timeout"},
                 {507, "Insufficient Storage"}};

    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        if (texts[i].status == status) return texts[i].text;
    return "Other";
}

static void write_member(FILE *head, const char *name, const char *value)
{
    if (value) fprintf(head, "%s: %s\r\n", name, value);
}

// The whole head of the answer, behind LWS_PRE bytes.
static void compose_head(struct http_request *request, const struct http_answer *answer, int status, size_t length)
{
    char *text = NULL;
    size_t size = 0;
    FILE *head = open_memstream(&text, &size);

    fprintf(head, "HTTP/1.1 %d %s\r\n%s", status, status_text(status), walls);
    write_member(head, "Content-Type", answer->type);
    if (status != 204 && status != 304) fprintf(head, "Content-Length: %zu\r\n", length);
    if (answer->etag) fprintf(head, "ETag: \"%s\"\r\n", answer->etag);
    write_member(head, "Cache-Control", answer->cache ? answer->cache : "no-store");
    write_member(head, "Location", answer->location);
    write_member(head, "Set-Cookie", answer->cookie);
    write_member(head, "Marchd-Picture", answer->picture);
    if (status == 401) write_member(head, "WWW-Authenticate", "Bearer");
    if (status == 503) write_member(head, "Retry-After", "2");
    write_member(head, "Connection", request->wants_close ? "close" : "keep-alive");
    fputs("\r\n", head);
    fclose(head);
    request->head = xmalloc(LWS_PRE + size);
    memcpy(request->head + LWS_PRE, text, size);
    request->head_size = size;
    http_credentials_free(text); // it may hold a session's token
}

static bool is_known(const struct http_request *request, const char *etag)
{
    const char *at = request->known_etag && etag ? strstr(request->known_etag, etag) : NULL;

    return at && at > request->known_etag && at[-1] == '"' && at[strlen(etag)] == '"';
}

// Makes room for the content, and where it is a file for one part of it; libwebsockets may have another part.
// False: too much waits already.
static bool hold_content(struct http_request *request, const struct http_answer *answer)
{
    size_t piece = answer->size_bytes < PIECE ? answer->size_bytes : PIECE;
    size_t room = LWS_PRE + (answer->has_file ? piece : answer->size_bytes);

    http_hold_give(&request->connection->hold, request->held); // its body is gone, or goes with this
    request->held = 0;
    if (answer->size_bytes > HTTP_SMALL_SIZE) {
        if (!http_hold_take(&request->connection->hold, room + piece)) return false;
        request->held = room + piece;
    }
    request->content = xmalloc(room);
    return true;
}

static void answer_later(struct http_request *request, const struct http_answer *answer)
{
    log_debug("%s: an answer of %zu bytes is too much", request->connection->peer.address, answer->size_bytes);
    if (answer->has_file) close(answer->file_fd);
    http_request_fail(request, 503, "too much waits here already: try again in a moment");
}

void http_request_answer(struct http_request *request, const struct http_answer *answer)
{
    bool is_cached = is_known(request, answer->etag);
    bool has_content = answer->size_bytes > 0 && !is_cached && !http_request_is_head(request);
    int status = is_cached ? 304 : answer->status ? answer->status : 200;

    if (has_content && !hold_content(request, answer)) {
        answer_later(request, answer);
        return;
    }
    // What was not read of it would be taken for the next request.
    if (!request->has_all) request->wants_close = true;
    compose_head(request, answer, status, answer->size_bytes);
    if (has_content) {
        if (!answer->has_file) memcpy(request->content + LWS_PRE, answer->bytes, answer->size_bytes);
        request->content_size = answer->size_bytes;
    }
    request->has_file = answer->has_file;
    request->file_fd = answer->file_fd;
    request->is_answered = true;
    http_connection_begin_sending(request->connection);
    lws_callback_on_writable(request->connection->wsi);
}

void http_request_fail(struct http_request *request, int status, const char *format, ...)
{
    struct json_writer writer = {0};
    va_list arguments;
    char text[1024];

    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    json_write_begin_object(&writer);
    json_write_string_member(&writer, "error", text);
    json_write_end_object(&writer);
    http_request_answer(
        request, &(struct http_answer){
                     .status = status, .type = "application/json", .bytes = writer.text, .size_bytes = writer.length});
    json_writer_finish(&writer);
}

bool http_request_write(struct http_request *request)
{
    struct lws *wsi = request->connection->wsi;

    http_connection_wait(request->connection, HTTP_WRITE_TIME_MS);
    if (!request->is_head_sent) {
        enum lws_write_protocol kind = request->content_size > 0 ? LWS_WRITE_HTTP_HEADERS : LWS_WRITE_HTTP_FINAL;

        if (lws_write(wsi, request->head + LWS_PRE, request->head_size, kind) < 0) return false;
        request->is_head_sent = true;
    } else {
        size_t rest = request->content_size - request->content_sent, size = rest < PIECE ? rest : PIECE;
        unsigned char *bytes = request->content + LWS_PRE + (request->has_file ? 0 : request->content_sent);

        if (request->has_file && pread(request->file_fd, bytes, size, (off_t)request->content_sent) != (ssize_t)size)
            return false;
        if (lws_write(wsi, bytes, size, size == rest ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < 0) return false;
        request->content_sent += size;
    }
    request->is_written = request->content_sent == request->content_size;
    return true;
}
