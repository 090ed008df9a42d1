// The head of a request: what libwebsockets has read of it, and whether it may go on.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct http_origins;
struct http_request;
struct lws;

// Why a request is refused.
struct http_refusal {
    int status; // 0: it is not
    const char *text;
};

// Fills what is asked and by whom. Where it is refused, the request holds enough to be answered.
struct http_refusal http_intake_read(struct http_request *request, struct lws *wsi, const struct http_origins *origins);
// Likewise for an upgrade to a WebSocket: a foreign page's is refused.
struct http_refusal http_intake_read_upgrade(struct http_request *request, struct lws *wsi,
                                             const struct http_origins *origins);
