// SPDX-License-Identifier: Apache-2.0
#include "cli/farm/token_request.h"

#include "cli/farm/daemon_call.h"
#include "cli/program/moment.h"
#include "cli/program/options.h"
#include "core/base/error.h"
#include "core/json/json_write.h"

#include <string.h>

static bool write_params(const struct token_request *request, struct json_writer *params, struct error *error)
{
    int64_t seconds = 0;

    if (request->expires && strcmp(request->expires, "never") != 0 &&
        !moment_parse_span(request->expires, &seconds, error)) {
        error_prefix(error, "--expires");
        return false;
    }
    json_write_begin_object(params);
    json_write_string_member(params, "scope", request->scope);
    json_write_string_member(params, "name", request->name);
    if (seconds > 0) json_write_integer_member(params, "expires_s", seconds);
    json_write_bool_member(params, "once", request->is_once);
    json_write_end_object(params);
    return true;
}

static bool read_reply(struct token_reply *token, struct error *error)
{
    struct json_node id = json_node_child(&token->reply.body, "id");
    struct json_node text = json_node_child(&token->reply.body, "token");

    return json_read_integer(&id, 1, INT64_MAX, &token->id, error) && json_read_string(&text, &token->text, error);
}

enum exit_status token_request_send(const struct options *options, const struct token_request *request,
                                    struct token_reply *token, struct error *error)
{
    struct json_writer params = {0};
    enum exit_status status = EXIT_STATUS_USAGE;

    if (write_params(request, &params, error))
        status = daemon_call(options, "token.create", params.text, &token->reply, error);
    json_writer_finish(&params);
    if (status != EXIT_STATUS_DONE || read_reply(token, error)) return status;
    message_finish(&token->reply);
    return EXIT_STATUS_FAILED;
}

bool token_request_parse_id(const char *text, int64_t *id, struct error *error)
{
    if (options_parse_id(text, id, NULL)) return true;
    error_set(error, "expected the number of a token, such as 7, got \"%s\"", text);
    return false;
}
