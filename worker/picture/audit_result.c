// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/audit_result.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

static const char *const names[] = {
    [AUDIT_NONE] = NULL, [AUDIT_REFERENCE] = "reference", [AUDIT_STEP_HALVING] = "step_halving"};

const char *audit_result_kind_name(enum audit_kind kind)
{
    return names[kind];
}

enum audit_kind audit_result_find_kind(const char *name)
{
    for (size_t kind = AUDIT_REFERENCE; kind < sizeof names / sizeof names[0]; kind++)
        if (!strcmp(names[kind], name)) return (enum audit_kind)kind;
    return AUDIT_NONE;
}

struct frame_accuracy audit_result_accuracy(const struct audit_result *audit, const char *method)
{
    struct frame_accuracy accuracy = {0};

    if (audit->kind == AUDIT_NONE) return accuracy;
    snprintf(accuracy.audit, sizeof accuracy.audit, "%s", names[audit->kind]);
    snprintf(accuracy.method, sizeof accuracy.method, "%s", method);
    accuracy.error = audit->error;
    accuracy.error95 = audit->error95;
    accuracy.audit_rays = audit->ray_count;
    accuracy.is_missed = audit->is_missed;
    return accuracy;
}
