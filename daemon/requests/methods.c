// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/methods.h"

#include "core/base/nearest_name.h"

#include <assert.h>
#include <string.h>

static const struct method *const tables[] = {methods_of_daemon, methods_of_changes, methods_of_jobs, methods_of_tokens,
                                              methods_of_notices};

enum { TABLE_COUNT = sizeof tables / sizeof tables[0] };

const struct method *methods_next(struct methods_walk *walk)
{
    while (walk->table < TABLE_COUNT) {
        const struct method *method = &tables[walk->table][walk->row++];

        if (method->name) return method;
        walk->table++;
        walk->row = 0;
    }
    return NULL;
}

const struct method *methods_find(const char *name)
{
    struct methods_walk walk = {0};
    const struct method *method;

    while ((method = methods_next(&walk))) {
        if (strcmp(method->name, name) == 0) return method;
    }
    return NULL;
}

const char *methods_find_nearest(const char *name)
{
    const char *names[METHOD_LIMIT + 1] = {NULL};
    struct methods_walk walk = {0};
    const struct method *method;

    for (size_t i = 0; (method = methods_next(&walk)); i++) {
        assert(i < METHOD_LIMIT);
        names[i] = method->name;
    }
    return nearest_name_find(name, names);
}

void methods_list_keys(const struct method *method, const char *keys[static METHOD_PARAM_LIMIT + 1])
{
    size_t count = 0;

    for (const struct member *param = method->params; param && param->name; param++) {
        assert(count < METHOD_PARAM_LIMIT);
        keys[count++] = param->name;
    }
    keys[count] = NULL;
}
