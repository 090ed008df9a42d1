// SPDX-License-Identifier: Apache-2.0
#include "daemon/settings/pool_command.h"

#include "core/base/error.h"
#include "core/job/root_marker.h"
#include "daemon/settings/pool_options.h"
#include "daemon/settings/slurm_commands.h"

#include <ctype.h>
#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static char **make_node(const struct pool_options *pool, const char *const arguments[], struct error *error)
{
    for (size_t i = 0; i < pool->node_count; i++)
        if (strcmp(pool->nodes[i].name, arguments[0]) == 0) return pool_options_format_command(pool, arguments[0]);
    error_set(error, "pool %s has no node %s", pool->name, arguments[0]);
    return NULL;
}

static bool read_number(const char *text, int64_t max, int64_t *number, struct error *error)
{
    char *end;

    errno = 0;
    *number = isdigit((unsigned char)*text) ? strtoll(text, &end, 10) : 0;
    if (*number > 0 && *number <= max && *end == '\0' && errno == 0) return true;
    error_set(error, "expected a number from 1 to %lld, got \"%s\"", (long long)max, text);
    return false;
}

static bool is_farm(const char *text, struct error *error)
{
    if (strlen(text) == ROOT_MARKER_ID_SIZE - 1 && strspn(text, "0123456789abcdef") == ROOT_MARKER_ID_SIZE - 1)
        return true;
    error_set(error, "expected the id of a farm, got \"%s\"", text);
    return false;
}

static char **make_step(const struct pool_options *pool, const char *const arguments[], struct error *error)
{
    int64_t job;

    return read_number(arguments[0], UINT32_MAX, &job, error) ? pool_options_format_command(pool, arguments[0]) : NULL;
}

static char **make_look(const struct pool_options *pool, const char *const arguments[], struct error *error)
{
    return is_farm(arguments[0], error) ? slurm_commands_make_look(pool, arguments[0]) : NULL;
}

static char **make_ask(const struct pool_options *pool, const char *const arguments[], struct error *error)
{
    int64_t number;

    if (!is_farm(arguments[0], error) || !read_number(arguments[1], pool->slurm.max, &number, error)) return NULL;
    if (arguments[2][0] == '/') return slurm_commands_make_ask(pool, arguments[0], (int)number, arguments[2]);
    error_set(error, "expected an absolute path, got \"%s\"", arguments[2]);
    return NULL;
}

static char **make_cancel(const struct pool_options *pool, const char *const arguments[], struct error *error)
{
    int64_t number, job;

    if (!is_farm(arguments[0], error) || !read_number(arguments[1], POOL_NODE_LIMIT, &number, error) ||
        !read_number(arguments[2], UINT32_MAX, &job, error))
        return NULL;
    return slurm_commands_make_cancel(pool, arguments[0], (int)number, job);
}

static const struct {
    bool is_slurm; // only pools of Slurm's have it; else only others
    const char *word;
    size_t argument_count;
    // The arguments are as many as they should be.
    char **(*make)(const struct pool_options *pool, const char *const arguments[], struct error *error);
} kinds[] = {{false, "node", 1, make_node},
             {true, "step", 1, make_step},
             {true, "look", 1, make_look},
             {true, "ask", 3, make_ask},
             {true, "cancel", 3, make_cancel}};

char **pool_command_make(const struct pool_options *pool, const char *const words[], struct error *error)
{
    const char *word = words[0] ? words[0] : "";
    size_t count = 0; // of arguments

    while (words[0] && words[count + 1])
        count++;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (kinds[i].is_slurm == (pool->launcher == POOL_SLURM) && count == kinds[i].argument_count &&
            strcmp(word, kinds[i].word) == 0)
            return kinds[i].make(pool, words + 1, error);
    error_set(error, "pool %s runs no command \"%s\" with %zu arguments", pool->name, word, count);
    return NULL;
}
