// SPDX-License-Identifier: Apache-2.0
#include "cli/farm/plan_beyond.h"

#include "cli/peer/connection.h"
#include "core/base/alloc.h"
#include "core/json/json_read.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

enum { PLANS_LIMIT = 1000 }; // that a daemon tells at most

static void read_plans(struct plan_beyond *plans, const struct json_node *list)
{
    struct json_node plan = {0};

    plans->list = xcalloc(json_node_count(list) + 1, sizeof *plans->list);
    while (json_node_next(list, &plan)) {
        struct plan_beyond_of *found = &plans->list[plans->count];
        struct json_node number = json_node_child(&plan, "number");

        if (json_read_integer(&number, 1, INT64_MAX, &found->number, NULL) &&
            job_beyond_read(&found->beyond, &plan, NULL) && found->beyond.is_known)
            plans->count++;
    }
}

void plan_beyond_ask(struct plan_beyond *plans, struct connection *connection, int64_t job)
{
    struct json_node list;
    struct message reply;
    char params[80];

    *plans = (struct plan_beyond){0};
    snprintf(params, sizeof params, "{\"id\":%" PRId64 ",\"limit\":%d}", job, PLANS_LIMIT);
    if (!connection_call(connection, "job.plans", params, &reply, NULL)) return;
    list = json_node_child(&reply.body, "plans");
    read_plans(plans, &list);
    message_finish(&reply);
}

const struct job_beyond *plan_beyond_find(const struct plan_beyond *plans, int64_t number)
{
    for (size_t i = 0; i < plans->count; i++)
        if (plans->list[i].number == number) return &plans->list[i].beyond;
    return NULL;
}

void plan_beyond_finish(struct plan_beyond *plans)
{
    free(plans->list);
    *plans = (struct plan_beyond){0};
}
