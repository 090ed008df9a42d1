// A request that is answered by one call to the daemon: what was wrong is told in HTTP's words.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "web/farm/farm_calls.h"

#include <stddef.h>

struct http_request;

// Called with the daemon's answer, which has come, and must answer the request. The text is borrowed.
typedef void web_on_answer(struct http_request *request, const struct farm_answer *answer, void *user);

// Calls with the request's own token. A request that goes away cancels the call; one whose token is not valid is
// answered with 401, and one while the daemon is away with 503. `text` NULL: the identity alone is asked for.
void web_calls_begin(struct farm_calls *calls, struct http_request *request, const char *text, size_t length,
                     web_on_answer *on_answer, void *user);
// Likewise, with another token, which may be NULL.
void web_calls_begin_as(struct farm_calls *calls, struct http_request *request, const char *token,
                        web_on_answer *on_answer, void *user);
