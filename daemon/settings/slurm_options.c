// SPDX-License-Identifier: Apache-2.0
#include "daemon/settings/slurm_options.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/settings/options_value.h"

#include <ctype.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { IDLE_MS = 60 * 1000, KEEP_MS = 120 * 1000, CPU_LIMIT = 4096 };

static const double SHORTEST_KEEP_S = 10;

const char slurm_options_keys[] = "partition, account, gres, time, arguments, min, max, cpus, idle, keep, lease";

void slurm_options_init(struct slurm_options *options)
{
    *options = (struct slurm_options){.max = 1, .idle_ms = IDLE_MS, .keep_ms = KEEP_MS};
}

void slurm_options_finish(struct slurm_options *options)
{
    free(options->partition);
    free(options->account);
    free(options->gres);
    free(options->time);
    free(options->lease_folder);
    option_words_free(options->arguments.words);
    *options = (struct slurm_options){0};
}

static bool read_text(const char *key, const char *value, char **text, struct error *error)
{
    for (const char *c = value; *c; c++) {
        if (isgraph((unsigned char)*c)) continue;
        error_set(error, "%s: expected printable characters without blanks", key);
        return false;
    }
    free(*text);
    *text = *value ? xstrdup(value) : NULL;
    return true;
}

static bool read_folder(const char *key, const char *value, char **folder, struct error *error)
{
    if (*value == '/') return read_text(key, value, folder, error);
    error_set(error, "%s: expected an absolute path, got \"%s\"", key, value);
    return false;
}

static bool read_least(const char *value, int *count, struct error *error)
{
    if (strcmp(value, "0") != 0) return options_value_count("min", value, SLURM_ALLOCATION_LIMIT, count, error);
    *count = 0;
    return true;
}

bool slurm_options_read(struct slurm_options *options, const char *key, const char *value, bool *is_known,
                        struct error *error)
{
    *is_known = true;
    if (strcmp(key, "partition") == 0) return read_text(key, value, &options->partition, error);
    if (strcmp(key, "account") == 0) return read_text(key, value, &options->account, error);
    if (strcmp(key, "gres") == 0) return read_text(key, value, &options->gres, error);
    if (strcmp(key, "time") == 0) return read_text(key, value, &options->time, error);
    if (strcmp(key, "arguments") == 0) return option_words_split(&options->arguments, value, error);
    if (strcmp(key, "min") == 0) return read_least(value, &options->min, error);
    if (strcmp(key, "max") == 0) return options_value_count(key, value, SLURM_ALLOCATION_LIMIT, &options->max, error);
    if (strcmp(key, "cpus") == 0) return options_value_count(key, value, CPU_LIMIT, &options->cpu_count, error);
    if (strcmp(key, "idle") == 0) return options_value_seconds(key, value, 1, &options->idle_ms, error);
    if (strcmp(key, "keep") == 0) return options_value_seconds(key, value, SHORTEST_KEEP_S, &options->keep_ms, error);
    if (strcmp(key, "lease") == 0) return read_folder(key, value, &options->lease_folder, error);
    *is_known = false;
    return true;
}

bool slurm_options_check(const struct slurm_options *options, struct error *error)
{
    if (options->min <= options->max) return true;
    error_set(error, "min: expected at most max, which is %d", options->max);
    return false;
}
