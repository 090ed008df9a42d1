// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/requests.h"

#include "core/json/json_write.h"
#include "daemon/clients/client.h"
#include "daemon/farm/farm.h"
#include "daemon/requests/methods.h"
#include "daemon/settings/options.h"

#include <string.h>

static enum request_outcome fail_method(struct request *request, const char *name)
{
    const char *nearest = methods_find_nearest(name);

    return request_fail(request, MESSAGE_CODE_NO_METHOD,
                        nearest ? "method: there is no \"%.60s\", did you mean \"%s\"?"
                                : "method: there is no \"%.60s\"%s",
                        name, nearest ? nearest : "");
}

// By name, too, for the user may have come after the daemon's start.
static bool is_web_user(const struct request *request)
{
    return rights_is_web_user(&request->farm->rights, &request->client->peer) ||
           strcmp(request->client->user, request->farm->options->web_user) == 0;
}

// The web user's connections begin as nobody's, but for notices.
static bool has_peer(const struct request *request, enum access_need need)
{
    const struct rights *rights = &request->farm->rights;
    const struct rights_peer *peer = &request->client->peer;

    if (need == NEED_NOTHING) return true;
    if (need == NEED_NOTICE)
        return is_web_user(request) || (rights_is_known(peer) && (peer->uid == 0 || peer->uid == rights->daemon_uid));
    return !is_web_user(request);
}

static bool check_access(struct request *request, const struct method *method)
{
    const struct access *access = &request->client->access;
    enum access_scope needed;

    if (access_has_expired(access, farm_clock_ms())) {
        request_fail(request, MESSAGE_CODE_NOT_ALLOWED, "token: it has expired");
        return false;
    }
    if (access_allows(access, method->need) && (access->kind != ACCESS_PEER || has_peer(request, method->need)))
        return true;
    if (access->kind == ACCESS_TOKEN && access_find_scope(method->need, &needed))
        request_fail(request, MESSAGE_CODE_NOT_ALLOWED, "%s: expected a token of scope %s, got one of scope %s",
                     method->name, access_scope_names[needed], access_scope_names[access->scope]);
    else if (access->kind == ACCESS_TOKEN || method->need == NEED_NOTICE)
        request_fail(request, MESSAGE_CODE_NOT_ALLOWED, "%s: no token gives the right to it", method->name);
    else
        request_fail(request, MESSAGE_CODE_NOT_ALLOWED, "%s: the connection is nobody's, expected auth.token before it",
                     method->name);
    return false;
}

static enum request_outcome handle(struct request *request, const char *name)
{
    const struct method *method = methods_find(name);
    const char *keys[METHOD_PARAM_LIMIT + 1];

    if (!method) return fail_method(request, name);
    if (!check_access(request, method)) return REQUEST_FAILED;
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
    if (client->access.wrong_count >= ACCESS_WRONG_LIMIT) client_end(client);
}
