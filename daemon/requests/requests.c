// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/requests.h"

#include "core/base/nearest_name.h"
#include "core/json/json_write.h"
#include "daemon/clients/client.h"

#include <string.h>

static const struct method {
    const char *name;
    enum request_outcome (*handle)(struct request *request);
    const char *keys[6]; // names of its parameters; end in NULL
} methods[] = {
    {"daemon.status", requests_daemon_status, {NULL}},
    {"daemon.drain", requests_daemon_drain, {NULL}},
    {"daemon.undrain", requests_daemon_undrain, {NULL}},
    {"daemon.reload", requests_daemon_reload, {NULL}},
    {"job.submit", requests_job_submit, {"document", "paused", NULL}},
    {"job.list", requests_job_list, {"state", "ids", NULL}},
    {"job.show", requests_job_show, {"id", NULL}},
    {"job.frames", requests_job_frames, {"id", "state", "range", "offset", "limit", NULL}},
    {"job.log", requests_job_log, {"id", "frame", "limit", NULL}},
    {"job.pause", requests_job_pause, {"id", NULL}},
    {"job.resume", requests_job_resume, {"id", NULL}},
    {"job.cancel", requests_job_cancel, {"id", NULL}},
    {"job.retry", requests_job_retry, {"id", "state", "range", "force", NULL}},
    {"job.delete", requests_job_delete, {"id", "files", NULL}},
    {"job.priority", requests_job_priority, {"id", "priority", NULL}},
    {"worker.list", requests_worker_list, {NULL}},
    {"events.subscribe", requests_events_subscribe, {"id", "frames", NULL}},
};

enum { METHOD_COUNT = sizeof methods / sizeof methods[0] };

static const struct method *find_method(const char *name)
{
    for (size_t i = 0; i < METHOD_COUNT; i++) {
        if (strcmp(methods[i].name, name) == 0) return &methods[i];
    }
    return NULL;
}

static enum request_outcome fail_method(struct request *request, const char *name)
{
    const char *names[METHOD_COUNT + 1] = {NULL};
    const char *nearest;

    for (size_t i = 0; i < METHOD_COUNT; i++)
        names[i] = methods[i].name;
    nearest = nearest_name_find(name, names);
    return request_fail(request, MESSAGE_CODE_NO_METHOD,
                        nearest ? "method: there is no \"%.60s\", did you mean \"%s\"?"
                                : "method: there is no \"%.60s\"%s",
                        name, nearest ? nearest : "");
}

static enum request_outcome handle(struct request *request, const char *name)
{
    const struct method *method = find_method(name);

    if (!method) return fail_method(request, name);
    request->code = MESSAGE_CODE_PARAMS;
    if (!json_node_is_absent(&request->params) && (!json_check_object(&request->params, &request->error) ||
                                                   !json_check_keys(&request->params, method->keys, &request->error)))
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
