// SPDX-License-Identifier: Apache-2.0
#include "daemon/settings/slurm_commands.h"

#include "core/base/alloc.h"
#include "daemon/settings/pool_options.h"

#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    FARM_DIGITS = 12,    // of the farm's id in names
    NAMES_AT_LEAST = 256 // that are looked for: more may have been allowed before
};

char *slurm_commands_format_token(const struct pool_options *pool, const char *farm)
{
    return xasprintf("march-%.*s-%s", FARM_DIGITS, farm, pool->name);
}

static char *format_name(const struct pool_options *pool, const char *farm, int number)
{
    char *token = slurm_commands_format_token(pool, farm), *name = xasprintf("%s.%d", token, number);

    free(token);
    return name;
}

static void add_all(struct option_words *command, const char *const words[])
{
    for (size_t i = 0; words[i]; i++)
        option_words_add(command, xstrdup(words[i]));
}

// "OPTION=VALUE"; nothing without a value.
static void add_value(struct option_words *command, const char *option, const char *value)
{
    if (value) option_words_add(command, xasprintf("%s=%s", option, value));
}

static char *format_names(const struct pool_options *pool, const char *farm)
{
    char *token = slurm_commands_format_token(pool, farm);
    size_t count = pool->node_count > NAMES_AT_LEAST ? pool->node_count : NAMES_AT_LEAST;
    char *names = xcalloc(count, strlen(token) + 12), *end = names;

    for (size_t i = 0; i < count; i++)
        end += sprintf(end, "%s%s.%zu", i > 0 ? "," : "", token, i + 1);
    free(token);
    return names;
}

char **slurm_commands_make_look(const struct pool_options *pool, const char *farm)
{
    static const char *const words[] = {"squeue", "--me", "--states=all", "--format=%i|%T|%N|%L|%j|%r", NULL};
    struct option_words command = {0};
    char *names = format_names(pool, farm);

    add_all(&command, words);
    add_value(&command, "--name", names);
    free(names);
    return command.words;
}

// In single quotes, for a shell.
static char *quote(const char *text)
{
    char *quoted = xmalloc(4 * strlen(text) + 3), *end = quoted;

    *end++ = '\'';
    for (; *text; text++) {
        if (*text == '\'') {
            memcpy(end, "'\\'", 3);
            end += 3;
        }
        *end++ = *text;
    }
    *end++ = '\'';
    *end = '\0';
    return quoted;
}

char *slurm_commands_format_script(const char *lease, int64_t keep_ms)
{
    int64_t keep_s = keep_ms / 1000, pause_s = keep_s < 100 ? keep_s / 10 : 10;
    char *quoted = quote(lease);
    char *script = xasprintf("lease=%s\n"
                             "last= since=\n"
                             "while :; do\n"
                             "    count=\n"
                             "    { read -r count <\"$lease\"; } 2>/dev/null\n"
                             "    read -r up rest </proc/uptime || exit 1\n"
                             "    up=${up%%.*}\n"
                             "    [ -n \"$since\" ] && [ \"$count\" = \"$last\" ] || { last=$count since=$up; }\n"
                             "    [ $((up - since)) -lt %" PRId64 " ] || exit 0\n"
                             "    sleep %" PRId64 "\n"
                             "done\n",
                             quoted, keep_s, pause_s > 0 ? pause_s : 1);

    free(quoted);
    return script;
}

char **slurm_commands_make_ask(const struct pool_options *pool, const char *farm, int number, const char *lease)
{
    static const char *const words[] = {
        "sbatch",    "--parsable",        "--no-requeue",       "--nodes=1",         "--ntasks=1",
        "--chdir=/", "--input=/dev/null", "--output=/dev/null", "--error=/dev/null", NULL};
    const struct slurm_options *options = &pool->slurm;
    struct option_words command = {0};
    char *name = format_name(pool, farm, number), *script = slurm_commands_format_script(lease, options->keep_ms);

    add_all(&command, words);
    option_words_add(&command, xasprintf("--cpus-per-task=%d", options->cpu_count));
    add_value(&command, "--job-name", name);
    add_value(&command, "--partition", options->partition);
    add_value(&command, "--account", options->account);
    add_value(&command, "--gres", options->gres);
    add_value(&command, "--time", options->time);
    for (size_t i = 0; i < options->arguments.count; i++)
        option_words_add(&command, xstrdup(options->arguments.words[i]));
    add_value(&command, "--wrap", script);
    free(name);
    free(script);
    return command.words;
}

char **slurm_commands_make_cancel(const struct pool_options *pool, const char *farm, int number, int64_t job)
{
    static const char *const words[] = {"scancel", "--me", NULL};
    struct option_words command = {0};
    char *name = format_name(pool, farm, number);

    add_all(&command, words);
    add_value(&command, "--name", name); // the id may be another job's by now
    option_words_add(&command, xasprintf("%" PRId64, job));
    free(name);
    return command.words;
}
