// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_after.h"

#include "core/base/alloc.h"
#include "core/json/json_read.h"

#include <inttypes.h>
#include <stdlib.h>

static bool read_ids(struct job_after *after, const struct json_node *node, struct error *error)
{
    struct json_node element = {0};

    if (!json_check_array(node, 0, JOB_AFTER_LIMIT, error)) return false;
    after->ids = xcalloc(json_node_count(node) + 1, sizeof after->ids[0]);
    while (json_node_next(node, &element)) {
        int64_t id;

        if (!json_read_integer(&element, 1, INT64_MAX, &id, error)) return false;
        for (size_t i = 0; i < after->count; i++)
            if (after->ids[i] == id) return json_fail(&element, error, "job %" PRId64 " is there twice", id);
        after->ids[after->count++] = id;
    }
    return true;
}

bool job_after_from_json(struct job_after *after, const struct json_node *document, struct error *error)
{
    static const char *const keys[] = {"jobs", "when", NULL};
    static const char *const words[] = {"succeeded", "over", NULL};
    struct json_node node = json_node_child(document, "after"), jobs = json_node_child(&node, "jobs"),
                     when = json_node_child(&node, "when");
    int choice = 0;

    if (json_node_is_absent(&node)) return true;
    if (json_node_type(&node) == JSON_ARRAY) return read_ids(after, &node, error);
    if (json_node_type(&node) != JSON_OBJECT)
        return json_fail_expected(&node, error, "an array of jobs' ids, or an object with \"jobs\" and \"when\"");
    if (!json_check_keys(&node, keys, error) || !read_ids(after, &jobs, error)) return false;
    if (!json_node_is_absent(&when) && !json_read_enum(&when, words, &choice, error)) return false;
    after->takes_any_end = choice == 1;
    return true;
}

struct job_after job_after_take(struct job_after *after)
{
    struct job_after taken = *after;

    *after = (struct job_after){0};
    return taken;
}

void job_after_finish(struct job_after *after)
{
    free(after->ids);
    *after = (struct job_after){0};
}
