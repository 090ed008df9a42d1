// SPDX-License-Identifier: Apache-2.0
#include "web/routes/web_calls.h"

#include "core/base/alloc.h"
#include "core/base/log.h"
#include "web/http/http_request.h"

#include <stdbool.h>
#include <stdlib.h>

struct asking {
    struct http_request *request;
    struct farm_call *call;
    bool is_own; // the token is the request's
    web_on_answer *on_answer;
    void *user;
};

static void on_gone(void *user)
{
    struct asking *asking = user;

    farm_call_cancel(asking->call);
    free(asking);
}

static void on_answered(void *user, const struct farm_answer *answer)
{
    struct asking *asking = user;
    struct http_request *request = asking->request;

    http_request_on_gone(request, NULL, NULL);
    if (asking->is_own && answer->end == FARM_OPEN) http_request_set_user(request, answer->identity->user);
    if (asking->is_own && answer->end == FARM_REFUSED) http_request_set_user(request, NULL);
    if (answer->end == FARM_OPEN) {
        asking->on_answer(request, answer, asking->user);
    } else if (answer->end == FARM_REFUSED) {
        log_debug("%s: a token that is not valid", http_request_address(request));
        http_request_fail(request, 401, "%s", answer->why);
    } else {
        log_debug("the daemon: %s", answer->why);
        http_request_fail(request, answer->end == FARM_AWAY ? 503 : 502, "the daemon: %s", answer->why);
    }
    free(asking);
}

static void begin(struct farm_calls *calls, struct http_request *request, const char *token, const char *text,
                  size_t length, web_on_answer *on_answer, void *user)
{
    struct asking *asking = xcalloc(1, sizeof *asking);

    *asking = (struct asking){.request = request,
                              .is_own = token && token == http_request_token(request),
                              .on_answer = on_answer,
                              .user = user};
    asking->call = farm_calls_begin(calls, token, text, length, on_answered, asking);
    http_request_on_gone(request, on_gone, asking);
}

void web_calls_begin(struct farm_calls *calls, struct http_request *request, const char *text, size_t length,
                     web_on_answer *on_answer, void *user)
{
    begin(calls, request, http_request_token(request), text, length, on_answer, user);
}

void web_calls_begin_as(struct farm_calls *calls, struct http_request *request, const char *token,
                        web_on_answer *on_answer, void *user)
{
    begin(calls, request, token, NULL, 0, on_answer, user);
}
