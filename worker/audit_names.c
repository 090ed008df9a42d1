#include "worker/audit_names.h"

#include <stddef.h>
#include <string.h>

static const char *const names[] = {
    [AUDIT_NONE] = NULL, [AUDIT_REFERENCE] = "reference", [AUDIT_STEP_HALVING] = "step_halving"};

const char *audit_name(enum audit_kind kind)
{
    return names[kind];
}

enum audit_kind audit_name_find(const char *name)
{
    for (size_t kind = AUDIT_REFERENCE; kind < sizeof names / sizeof names[0]; kind++)
        if (!strcmp(names[kind], name)) return (enum audit_kind)kind;
    return AUDIT_NONE;
}
