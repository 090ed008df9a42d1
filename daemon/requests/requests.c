// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/requests.h"

#include "core/json/json_write.h"
#include "daemon/clients/client.h"
#include "daemon/requests/methods.h"

static enum request_outcome fail_method(struct request *request, const char *name)
{
    const char *nearest = methods_find_nearest(name);

    return request_fail(request, MESSAGE_CODE_NO_METHOD,
                        nearest ? "method: there is no \"%.60s\", did you mean \"%s\"?"
                                : "method: there is no \"%.60s\"%s",
                        name, nearest ? nearest : "");
}

static enum request_outcome handle(struct request *request, const char *name)
{
    const struct method *method = methods_find(name);
    const char *keys[METHOD_PARAM_LIMIT + 1];

    if (!method) return fail_method(request, name);
    request->code = MESSAGE_CODE_PARAMS;
    methods_list_keys(method, keys);
    if (!json_node_is_absent(&request->params) && (!json_check_object(&request->params, &request->error) ||
                                                   !json_check_keys(&request->params, keys, &request->error)))
        return REQUEST_FAILED;
    return method->handle(request);
}

void requests_handle(struct farm *farm, struct client *client, struct message *message)
{
    struct json_writer result = {0};
    struct request request = {.farm = farm,
                              .client = client,
                              .message = message,
                              .id = message->id,
                              .params = message->body,
                              .result = &result};

    switch (handle(&request, message->method)) {
    case REQUEST_ANSWERED:
        client_send_result(client, request.id, &result);
        break;
    case REQUEST_FAILED:
        client_send_error(client, request.id, request.code, request.error.message);
        break;
    case REQUEST_DEFERRED:
        break;
    }
    json_writer_finish(&result);
}
