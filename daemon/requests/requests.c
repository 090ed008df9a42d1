// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/requests.h"

#include "core/base/alloc.h"
#include "core/base/nearest_name.h"
#include "core/json/json_write.h"
#include "daemon/clients/client.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/job_view.h"
#include "daemon/settings/options.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct method {
    const char *name;
    enum request_outcome (*handle)(struct request *request);
    const char *keys[6]; // of its parameters; end in NULL
} methods[] = {
    {"daemon.status", requests_daemon_status, {NULL}},
    {"job.submit", requests_job_submit, {"document", "paused", NULL}},
    {"job.list", requests_job_list, {"state", NULL}},
    {"job.show", requests_job_show, {"id", NULL}},
    {"job.frames", requests_job_frames, {"id", "state", "range", "offset", "limit", NULL}},
    {"job.log", requests_job_log, {"id", "frame", "limit", NULL}},
    {"job.pause", requests_job_pause, {"id", NULL}},
    {"job.resume", requests_job_resume, {"id", NULL}},
    {"job.cancel", requests_job_cancel, {"id", NULL}},
    {"job.retry", requests_job_retry, {"id", "state", "range", NULL}},
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

static void send_result(struct client *client, const char *id, const struct json_writer *value)
{
    struct json_writer writer = {0};

    if (!id[0]) return;
    message_begin_result(&writer, id);
    json_write_raw(&writer, value->text, value->length);
    message_end(&writer);
    client_send(client, writer.text, writer.length);
    json_writer_finish(&writer);
}

static void send_error(struct client *client, const char *id, enum message_code code, const char *text)
{
    struct json_writer writer = {0};

    if (!id[0]) return;
    message_write_error(&writer, id, code, text);
    client_send(client, writer.text, writer.length);
    json_writer_finish(&writer);
}

void requests_handle(struct farm *farm, struct client *client, const struct message *message)
{
    struct json_writer result = {0};
    struct request request = {
        .farm = farm, .client = client, .id = message->id, .params = message->body, .result = &result};

    switch (handle(&request, message->method)) {
    case REQUEST_ANSWERED:
        send_result(client, request.id, &result);
        break;
    case REQUEST_FAILED:
        send_error(client, request.id, request.code, request.error.message);
        break;
    case REQUEST_OWED:
        break;
    }
    json_writer_finish(&result);
}

enum request_outcome request_fail(struct request *request, enum message_code code, const char *format, ...)
{
    va_list arguments;

    request->code = code;
    va_start(arguments, format);
    vsnprintf(request->error.message, sizeof request->error.message, format, arguments);
    va_end(arguments);
    return REQUEST_FAILED;
}

struct job_record *request_find_job(struct request *request)
{
    struct json_node node = json_node_child(&request->params, "id");
    struct job_record *record;
    int64_t id;

    request->code = MESSAGE_CODE_PARAMS;
    if (!json_read_integer(&node, 1, INT64_MAX, &id, &request->error)) return NULL;
    record = job_table_find(&request->farm->jobs, id);
    if (!record) request_fail(request, MESSAGE_CODE_NOT_FOUND, "job %lld: there is no such job", (long long)id);
    return record;
}

bool request_may_change(const struct request *request, const struct job_record *record)
{
    return rights_may_change(&request->farm->rights, &request->client->peer, record->owner_uid);
}

struct job_record *request_find_own_job(struct request *request)
{
    struct job_record *record = request_find_job(request);

    if (!record || request_may_change(request, record)) return record;
    request_fail(request, MESSAGE_CODE_NOT_ALLOWED,
                 "job %lld belongs to %s: only they, root, the daemon's user and group %s may change it, not %s",
                 (long long)record->id, record->owner, request->farm->options->admin_group, request->client->user);
    return NULL;
}

static bool add_name(struct request *request, const struct json_node *node, const char *const names[], unsigned *set)
{
    int choice;

    if (!json_read_enum(node, names, &choice, &request->error)) return false;
    *set |= 1U << choice;
    return true;
}

bool request_read_set(struct request *request, const char *key, const char *const names[], unsigned fallback,
                      unsigned *set)
{
    struct json_node node = json_node_child(&request->params, key);
    struct json_node name = {0};

    request->code = MESSAGE_CODE_PARAMS;
    *set = 0;
    if (json_node_is_absent(&node)) {
        *set = fallback;
        return true;
    }
    if (json_node_type(&node) != JSON_ARRAY) return add_name(request, &node, names, set);
    while (json_node_next(&node, &name)) {
        if (!add_name(request, &name, names, set)) return false;
    }
    return true;
}

struct answer {
    struct farm *farm;
    struct client *client; // held until the answer is sent
    char id[MESSAGE_ID_SIZE];
};

struct answer *answer_owe(const struct request *request)
{
    struct answer *answer = xcalloc(1, sizeof *answer);

    answer->farm = request->farm;
    answer->client = request->client;
    strncpy(answer->id, request->id, sizeof answer->id - 1);
    client_hold(answer->client);
    return answer;
}

void answer_send_result(struct answer *answer, const struct json_writer *value)
{
    send_result(answer->client, answer->id, value);
    client_release(answer->client);
    free(answer);
}

void answer_send_job(struct answer *answer, struct job_record *record)
{
    struct json_writer value = {0};

    job_view_write(answer->farm, record, &value);
    answer_send_result(answer, &value);
    json_writer_finish(&value);
}

void answer_send_error(struct answer *answer, enum message_code code, const char *text)
{
    send_error(answer->client, answer->id, code, text);
    client_release(answer->client);
    free(answer);
}
