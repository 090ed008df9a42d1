// SPDX-License-Identifier: Apache-2.0
#include "daemon/settings/pool_command.h"

#include "core/base/error.h"
#include "daemon/settings/pool_options.h"

#include <stddef.h>
#include <string.h>

static char **make_node(const struct pool_options *pool, const char *const arguments[], struct error *error)
{
    for (size_t i = 0; i < pool->node_count; i++)
        if (strcmp(pool->nodes[i].name, arguments[0]) == 0) return pool_options_format_command(pool, arguments[0]);
    error_set(error, "pool %s has no node %s", pool->name, arguments[0]);
    return NULL;
}

static const struct {
    const char *word;
    size_t argument_count;
    // The arguments are as many as they should be.
    char **(*make)(const struct pool_options *pool, const char *const arguments[], struct error *error);
} kinds[] = {{"node", 1, make_node}};

char **pool_command_make(const struct pool_options *pool, const char *const words[], struct error *error)
{
    const char *word = words[0] ? words[0] : "";
    size_t count = 0; // of arguments

    while (words[0] && words[count + 1])
        count++;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (count == kinds[i].argument_count && strcmp(word, kinds[i].word) == 0)
            return kinds[i].make(pool, words + 1, error);
    error_set(error, "pool %s runs no command \"%s\" with %zu arguments", pool->name, word, count);
    return NULL;
}
