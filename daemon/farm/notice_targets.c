// SPDX-License-Identifier: Apache-2.0
#include "daemon/farm/notice_targets.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/nearest_name.h"

#include <stdlib.h>
#include <string.h>

void notice_targets_finish(struct notice_targets *targets)
{
    for (size_t i = 0; i < targets->count; i++)
        free(targets->names[i]);
    free(targets->names);
    *targets = (struct notice_targets){0};
}

void notice_targets_add(struct notice_targets *targets, const char *name)
{
    targets->names = xgrow(targets->names, &targets->capacity, targets->count + 1, sizeof targets->names[0]);
    targets->names[targets->count++] = xstrdup(name);
}

static bool has_name(const struct notice_targets *targets, const char *name)
{
    for (size_t i = 0; i < targets->count; i++)
        if (strcmp(targets->names[i], name) == 0) return true;
    return false;
}

static void fail_name(const struct notice_targets *targets, size_t rule, const char *name, struct error *error)
{
    const char *names[NOTICE_TARGETS_LIMIT + 1] = {NULL};
    const char *nearest;

    for (size_t i = 0; i < targets->count && i < NOTICE_TARGETS_LIMIT; i++)
        names[i] = targets->names[i];
    nearest = nearest_name_find(name, names);
    if (targets->count == 0)
        error_set(error, "notify[%zu].to: there is no target \"%s\": the farm has none", rule, name);
    else if (nearest)
        error_set(error, "notify[%zu].to: there is no target \"%s\", did you mean \"%s\"?", rule, name, nearest);
    else
        error_set(error, "notify[%zu].to: there is no target \"%s\" in the settings of march-web", rule, name);
}

bool notice_targets_check(const struct notice_targets *targets, const struct job_notify *notify, struct error *error)
{
    for (size_t i = 0; i < notify->count && targets->is_known; i++) {
        const struct job_notify_rule *rule = &notify->rules[i];

        if (rule->webhook && !targets->has_webhooks) {
            error_set(error, "notify[%zu].webhook: jobs of this farm may not name addresses: name a target with \"to\"",
                      i);
            return false;
        }
        if (rule->to && !has_name(targets, rule->to)) {
            fail_name(targets, i, rule->to, error);
            return false;
        }
    }
    return true;
}
