// SPDX-License-Identifier: Apache-2.0
#include "cli/job/job_notify_set.h"

#include "cli/job/json_set.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job_notify.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"

#include <stdlib.h>
#include <string.h>

static size_t count_rules(const char *document)
{
    struct cJSON *root = NULL;
    struct json_node node, notify;
    size_t count = 0;

    if (!json_parse(&root, document, strlen(document), NULL)) return 0;
    node = json_node_root(root);
    notify = json_node_child(&node, "notify");
    if (json_node_type(&notify) == JSON_ARRAY) count = (size_t)json_node_count(&notify);
    json_delete(root);
    return count;
}

static void write_rule(struct json_writer *writer, const struct job_notify_rule *rule)
{
    json_write_begin_object(writer);
    json_write_key(writer, "on");
    json_write_begin_array(writer);
    for (int event = 0; event < JOB_NOTIFY_EVENT_COUNT; event++)
        if (rule->on & 1U << event) json_write_string(writer, job_notify_event_names[event]);
    json_write_end_array(writer);
    json_write_string_member(writer, "to", rule->to);
    json_write_end_object(writer);
}

bool job_notify_set(char **document, const char *text, struct error *error)
{
    struct job_notify notify = {0};
    struct json_writer rule = {0};
    size_t count = count_rules(*document);
    char *assignment, *edited;

    if (!job_notify_parse(&notify, text, error)) {
        error_prefix(error, "--notify");
        return false;
    }
    write_rule(&rule, &notify.rules[0]);
    if (count == 0)
        assignment = xasprintf("notify=[%s]", rule.text);
    else
        assignment = xasprintf("notify[%zu]=%s", count, rule.text);
    edited = json_set(*document, assignment, error);
    free(assignment);
    json_writer_finish(&rule);
    job_notify_finish(&notify);
    if (!edited) return false;
    free(*document);
    *document = edited;
    return true;
}
