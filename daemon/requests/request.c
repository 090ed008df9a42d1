// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/request.h"

#include "core/job/job.h"
#include "daemon/clients/answer.h"
#include "daemon/clients/client.h"
#include "daemon/farm/farm.h"
#include "daemon/settings/options.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

// What is read on the loop, or kept for a thread.
enum { SET_LIMIT = 64, RANGE_TEXT_LIMIT = 64 * 1024 };

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

bool request_may_have_priority(struct request *request, int64_t priority)
{
    if (priority <= JOB_PRIORITY_USER_MAX || rights_is_admin(&request->farm->rights, &request->client->peer))
        return true;
    request_fail(request, MESSAGE_CODE_NOT_ALLOWED,
                 "priority: expected at most %d, got %lld: higher ones are for root, the daemon's user and group %s",
                 JOB_PRIORITY_USER_MAX, (long long)priority, request->farm->options->admin_group);
    return false;
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
    if (!json_check_array(&node, 0, SET_LIMIT, &request->error)) return false;
    while (json_node_next(&node, &name)) {
        if (!add_name(request, &name, names, set)) return false;
    }
    return true;
}

bool request_read_flag(struct request *request, const char *key, bool *flag)
{
    struct json_node node = json_node_child(&request->params, key);

    request->code = MESSAGE_CODE_PARAMS;
    return json_node_is_absent(&node) || json_read_bool(&node, flag, &request->error);
}

bool request_read_count(struct request *request, const char *key, int64_t min, int64_t max, int64_t fallback,
                        int64_t *count)
{
    struct json_node node = json_node_child(&request->params, key);

    *count = fallback;
    request->code = MESSAGE_CODE_PARAMS;
    return json_node_is_absent(&node) || json_read_integer(&node, min, max, count, &request->error);
}

bool request_read_range(struct request *request, const char **text)
{
    struct json_node node = json_node_child(&request->params, "range");

    *text = NULL;
    request->code = MESSAGE_CODE_PARAMS;
    if (json_node_is_absent(&node)) return true;
    if (!json_read_string(&node, text, &request->error)) return false;
    return strlen(*text) <= RANGE_TEXT_LIMIT ||
           json_fail(&node, &request->error, "expected at most %d bytes", RANGE_TEXT_LIMIT);
}

struct answer *request_defer_answer(const struct request *request, bool is_long)
{
    return answer_create(request->client, request->id, is_long);
}
