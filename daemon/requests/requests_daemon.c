// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/requests.h"

#include "core/json/json_write.h"
#include "daemon/clients/client.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/drain.h"
#include "daemon/settings/options.h"
#include "daemon/settings/reload.h"

#include <string.h>

static bool check_admin(struct request *request, const char *what)
{
    if (rights_is_admin(&request->farm->rights, &request->client->peer)) return true;
    request_fail(request, MESSAGE_CODE_NOT_ALLOWED, "only root, the daemon's user and group %s may %s, not %s",
                 request->farm->options->admin_group, what, request->client->user);
    return false;
}

static enum request_outcome answer_running(struct request *request)
{
    json_write_begin_object(request->result);
    json_write_integer_member(request->result, "running", queue_count(request->farm->queue, FRAME_RUNNING));
    json_write_end_object(request->result);
    return REQUEST_ANSWERED;
}

enum request_outcome requests_daemon_drain(struct request *request)
{
    if (!check_admin(request, "drain the farm")) return REQUEST_FAILED;
    drain_begin(request->farm, request->client->user);
    return answer_running(request);
}

enum request_outcome requests_daemon_undrain(struct request *request)
{
    if (!check_admin(request, "end a drain")) return REQUEST_FAILED;
    drain_end(request->farm, request->client->user);
    return answer_running(request);
}

// Writes names that are separated by commas as an array.
static void write_names(struct json_writer *writer, const char *key, char *names)
{
    json_write_key(writer, key);
    json_write_begin_array(writer);
    for (char *rest = names, *name; (name = strtok_r(rest, ", ", &rest));)
        json_write_string(writer, name);
    json_write_end_array(writer);
}

enum request_outcome requests_daemon_reload(struct request *request)
{
    struct reload_changes changes = {0};

    if (!check_admin(request, "have the settings read again")) return REQUEST_FAILED;
    request->code = MESSAGE_CODE_CONFLICT;
    if (!request->farm->reload(request->farm->reload_user, request->client->user, &changes, &request->error))
        return REQUEST_FAILED;
    json_write_begin_object(request->result);
    write_names(request->result, "changed", changes.applied);
    write_names(request->result, "restart", changes.waiting);
    json_write_end_object(request->result);
    return REQUEST_ANSWERED;
}
