// SPDX-License-Identifier: Apache-2.0
#include "web/routes/route_metrics.h"

#include "core/base/error.h"
#include "core/wire/message.h"
#include "core/wire/metrics_text.h"
#include "web/http/http_request.h"
#include "web/routes/web_calls.h"

#include <stdlib.h>
#include <string.h>

static const char question[] = "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"daemon.metrics\",\"params\":{}}";

// NULL, with the status of HTTP and the cause.
static char *format(const struct farm_answer *answer, int *status, struct error *error)
{
    struct message message = {0};
    enum message_code code;
    char *text = NULL;

    *status = 502;
    if (!message_decode(&message, answer->line, answer->length, &code, error)) {
        error_prefix(error, "the daemon's answer");
    } else if (message.kind == MESSAGE_ERROR) {
        if (message.code == MESSAGE_CODE_NOT_ALLOWED) *status = 403;
        error_set(error, "%s", message.text);
    } else if (!(text = metrics_text_format(&message.body, error))) {
        error_prefix(error, "the daemon's answer");
    }
    message_finish(&message);
    return text;
}

static void on_answer(struct http_request *request, const struct farm_answer *answer, void *user)
{
    struct error error = {0};
    int status;
    char *text = format(answer, &status, &error);

    (void)user;
    if (text)
        http_request_answer(
            request, &(struct http_answer){.type = METRICS_TEXT_TYPE, .bytes = text, .size_bytes = strlen(text)});
    else
        http_request_fail(request, status, "%s", error.message);
    free(text);
}

void route_metrics(struct http_request *request, void *user)
{
    web_calls_begin(user, request, question, sizeof question - 1, on_answer, NULL);
}
