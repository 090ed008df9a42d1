// One HTTP request: what is asked, with whose token, and its one answer.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct http_request;

// The zero value is an empty answer with status 200. All is copied.
struct http_answer {
    int status;           // 0: 200
    const char *type;     // Content-Type; NULL: none
    const void *bytes;    // NULL: no body
    size_t size_bytes;    // of the body
    bool has_file;        // the body is so many bytes of a file from its start, in place of `bytes`
    int file_fd;          // taken over, also where no body is wanted
    const char *picture;  // Marchd-Picture, or NULL: what is known of a picture
    const char *etag;     // names these bytes; NULL: none. A client that has them is answered with 304.
    const char *cache;    // Cache-Control; NULL: "no-store"
    const char *location; // of a redirection, or NULL
    const char *cookie;   // Set-Cookie, or NULL
};

// Who answers. `path` is a whole path, or with `is_prefix` what a path begins with.
struct http_route {
    const char *method; // "GET", which HEAD is answered by too, or "POST"
    const char *path;
    bool is_prefix;
    bool needs_token;  // a request without one is answered with 401 before
    size_t body_limit; // bytes; a larger body is answered with 413 before
    // Called when the request is there with all of its body. It must lead to one http_request_answer, now or later.
    void (*answer)(struct http_request *request, void *user);
    void *user;
};

// Texts are borrowed and live as long as the request.
const char *http_request_path(const struct http_request *request); // decoded; begins with '/'
// The value of NAME=VALUE in the address, decoded; NULL: it is not there. The first where there are several.
const char *http_request_query(const struct http_request *request, const char *name);
size_t http_request_query_count(const struct http_request *request);
const char *http_request_query_at(const struct http_request *request, size_t index); // "NAME=VALUE"
const char *http_request_token(const struct http_request *request);                  // NULL: none
const char *http_request_known_etag(const struct http_request *request);             // If-None-Match; NULL: none
// Legal until the route's `answer` returns.
const char *http_request_body(const struct http_request *request, size_t *size_bytes);
const char *http_request_address(const struct http_request *request); // of the peer, for the log
bool http_request_is_head(const struct http_request *request);        // only the answer's head is wanted
bool http_request_is_secure(const struct http_request *request);      // the browser sees an https address
// True where the browser says that another site made it ask.
bool http_request_is_from_elsewhere(const struct http_request *request);

// What the farm has said to the request's token: whose it is, or NULL: it is not valid. It decides whose share of
// march-web the request uses.
void http_request_set_user(struct http_request *request, const char *user);

// `on_gone` is called when the client goes away before the answer, and the request is freed afterwards.
void http_request_on_gone(struct http_request *request, void (*on_gone)(void *user), void *user);
// Both end the request: it is not touched afterwards. The second answers {"error": text}.
void http_request_answer(struct http_request *request, const struct http_answer *answer);
void http_request_fail(struct http_request *request, int status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
