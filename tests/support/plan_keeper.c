// SPDX-License-Identifier: Apache-2.0
#include "tests/support/plan_keeper.h"

static enum plan_source_answer find(void *user, const char *key, int64_t *number, struct plan_json *plan,
                                    struct error *error)
{
    struct plan_keeper *keeper = user;

    (void)key;
    (void)error;
    if (keeper->number == 0) return PLAN_SOURCE_MAKE;
    if (*number != keeper->number) *plan = keeper->plan;
    *number = keeper->number;
    return PLAN_SOURCE_HAS;
}

static enum plan_source_answer keep(void *user, const char *key, int64_t missed, const struct plan_json *plan,
                                    int64_t *number, struct error *error)
{
    struct plan_keeper *keeper = user;

    (void)key;
    (void)error;
    keeper->plan = *plan;
    if (keeper->number == 0) keeper->first_sample_count = plan->sample_count;
    keeper->replaced = missed;
    *number = ++keeper->number;
    return PLAN_SOURCE_HAS;
}

struct plan_source plan_keeper_source(struct plan_keeper *keeper)
{
    return (struct plan_source){.find = find, .keep = keep, .user = keeper};
}
