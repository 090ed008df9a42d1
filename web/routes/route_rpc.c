// SPDX-License-Identifier: Apache-2.0
#include "web/routes/route_rpc.h"

#include "core/base/error.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "web/http/http_request.h"
#include "web/routes/web_calls.h"

#include <string.h>

static void answer_text(struct http_request *request, const char *text, size_t length)
{
    http_request_answer(request,
                        &(struct http_answer){.type = "application/json", .bytes = text, .size_bytes = length});
}

static void answer_error(struct http_request *request, const char *id, enum message_code code, const char *text)
{
    struct json_writer writer = {0};

    message_write_error(&writer, id, code, text);
    answer_text(request, writer.text, writer.length);
    json_writer_finish(&writer);
}

static void on_answer(struct http_request *request, const struct farm_answer *answer, void *user)
{
    (void)user;
    answer_text(request, answer->line, answer->length);
}

// What makes no sense for one call over a connection that others may use after it; NULL: it does.
static const char *find_fault(const struct message *message)
{
    if (message->kind != MESSAGE_REQUEST) return "expected a request with an id, which is answered";
    if (strncmp(message->method, "events.", 7) == 0) return "events come over the WebSocket alone";
    if (strncmp(message->method, "auth.", 5) == 0) return "the token is that of the HTTP request";
    return NULL;
}

void route_rpc(struct http_request *request, void *user)
{
    size_t length;
    const char *body = http_request_body(request, &length), *fault;
    struct message message = {0};
    enum message_code code;
    struct error error = {0};

    if (!message_decode(&message, body, length, &code, &error))
        answer_error(request, *message.id ? message.id : "null", code, error.message);
    else if ((fault = find_fault(&message)))
        answer_error(request, *message.id ? message.id : "null", MESSAGE_CODE_INVALID, fault);
    else
        web_calls_begin(user, request, body, length, on_answer, NULL);
    message_finish(&message);
}
