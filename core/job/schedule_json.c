// SPDX-License-Identifier: Apache-2.0
#include "core/job/schedule_json.h"

#include "core/base/alloc.h"
#include "core/job/job.h"
#include "core/json/json_read.h"

#include <ctype.h>
#include <string.h>

static bool read_stage(const struct json_node *node, int32_t *stage, struct error *error)
{
    static const char *const names[] = {"first", "last", "middle", NULL};
    static const int32_t stages[] = {FRAME_ORDER_FIRST, FRAME_ORDER_LAST, FRAME_ORDER_MIDDLE};
    int64_t every;
    int choice;

    if (json_node_type(node) == JSON_STRING) {
        if (!json_read_enum(node, names, &choice, error)) return false;
        *stage = stages[choice];
        return true;
    }
    if (!json_read_integer(node, 2, FRAME_NUMBER_LIMIT, &every, NULL))
        return json_fail_expected(node, error,
                                  "\"first\", \"last\", \"middle\" or a whole number n from 2, for every n-th");
    *stage = (int32_t)every;
    return true;
}

static bool read_order(struct frame_order *order, const struct json_node *document, struct error *error)
{
    struct json_node node = json_node_child(document, "order"), stage = {0};

    if (json_node_is_absent(&node)) return true;
    if (!json_check_array(&node, 0, FRAME_ORDER_LIMIT, error)) return false;
    while (json_node_next(&node, &stage))
        if (!read_stage(&stage, &order->stages[order->count++], error)) return false;
    return true;
}

bool schedule_is_pool_name(const char *text)
{
    if (!isalnum((unsigned char)*text) || strlen(text) > JOB_POOL_LIMIT) return false;
    for (; *text; text++)
        if (!isalnum((unsigned char)*text) && !strchr("-._@:", *text)) return false;
    return true;
}

static bool read_pool(struct job *job, const struct json_node *document, struct error *error)
{
    struct json_node node = json_node_child(document, "pool");
    const char *text;

    if (json_node_is_absent(&node)) return true;
    if (!json_read_string(&node, &text, error)) return false;
    if (!schedule_is_pool_name(text))
        return json_fail_expected(&node, error, "a pool's name or tag: 1 to 64 letters, digits and -._@:");
    job->pool = xstrdup(text);
    return true;
}

bool schedule_from_json(struct job *job, const struct json_node *document, struct error *error)
{
    struct json_node priority = json_node_child(document, "priority");
    struct json_node limit = json_node_child(document, "frame_limit");
    int64_t rank = JOB_PRIORITY_DEFAULT;

    if (!json_node_is_absent(&priority) && !json_read_integer(&priority, 0, JOB_PRIORITY_MAX, &rank, error))
        return false;
    if (!json_node_is_absent(&limit) && !json_read_number(&limit, 1, JOB_FRAME_LIMIT_MAX, &job->frame_limit, error))
        return false;
    job->priority = (int)rank;
    return read_pool(job, document, error) && read_order(&job->order, document, error);
}
