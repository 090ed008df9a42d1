// SPDX-License-Identifier: Apache-2.0
#include "daemon/settings/pool_options.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/schedule_json.h"
#include "core/settings/option_words.h"
#include "core/settings/options_value.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NODE_NAME_LENGTH = 255 };

void pool_options_free_command(char **command)
{
    option_words_free(command);
}

// It stands in messages and in command lines: it looks like no option and holds nothing that a shell reads.
static bool is_node_name(const char *text)
{
    if (!isalnum((unsigned char)*text) || strlen(text) > NODE_NAME_LENGTH) return false;
    for (; *text; text++)
        if (!isalnum((unsigned char)*text) && !strchr("-._@:[]", *text)) return false;
    return true;
}

static bool read_node(struct pool_node *node, char *text, struct error *error)
{
    char *equals = strchr(text, '=');

    *node = (struct pool_node){0};
    if (equals) *equals = '\0';
    if (!is_node_name(text)) {
        error_set(error, "nodes: expected a machine's name, got \"%s\"", text);
        return false;
    }
    if (equals && !options_value_count("nodes", equals + 1, POOL_WORKER_LIMIT, &node->worker_count, error))
        return false;
    node->name = xstrdup(text);
    return true;
}

static bool read_nodes(struct pool_options *pool, const char *value, struct error *error)
{
    char *copy = xstrdup(value), *rest = copy, *word;
    bool ok = true;

    while (ok && (word = strsep(&rest, ", ")) != NULL) {
        if (!*word) continue;
        if (pool->node_count == POOL_NODE_LIMIT) {
            error_set(error, "nodes: expected at most %d", POOL_NODE_LIMIT);
            break;
        }
        pool->nodes = xrealloc(pool->nodes, (pool->node_count + 1) * sizeof pool->nodes[0]);
        ok = read_node(&pool->nodes[pool->node_count], word, error);
        for (size_t i = 0; ok && i < pool->node_count; i++) {
            if (strcmp(pool->nodes[i].name, word) != 0) continue;
            error_set(error, "nodes: %s stands there twice", word);
            free(pool->nodes[pool->node_count].name);
            ok = false;
        }
        pool->node_count += ok;
    }
    free(copy);
    return ok;
}

static bool read_launcher(struct pool_options *pool, const char *value, struct error *error)
{
    static const char *const names[] = {[POOL_COMMAND] = "command", [POOL_SSH] = "ssh", [POOL_SLURM] = "slurm"};

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (strcmp(value, names[i]) != 0) continue;
        pool->launcher = (enum pool_launcher)i;
        return true;
    }
    error_set(error, "launcher: expected command, ssh or slurm, got \"%s\"", value);
    return false;
}

// What a pool reads before its settings are put together.
struct reading {
    struct pool_options *pool;
    int worker_count;   // of nodes without a count
    char *program;      // owned; on the nodes
    char *command;      // owned
    char *ssh_config;   // owned; ssh's file of settings
    char slurm_key[16]; // a setting of launcher=slurm that was read; "": none
};

static bool read_landlock(struct pool_options *pool, const char *value, struct error *error)
{
    pool->wants_landlock = strcmp(value, "required") == 0;
    if (pool->wants_landlock || strcmp(value, "optional") == 0) return true;
    error_set(error, "landlock: expected required or optional, got \"%s\"", value);
    return false;
}

static bool read_text(char **text, const char *value)
{
    free(*text);
    *text = xstrdup(value);
    return true;
}

static bool read_ssh_config(struct reading *reading, const char *value, struct error *error)
{
    if (*value == '/') return read_text(&reading->ssh_config, value);
    error_set(error, "ssh-config: expected an absolute path, got \"%s\"", value);
    return false;
}

static bool read_setting(struct reading *reading, const char *key, const char *value, struct error *error)
{
    struct pool_options *pool = reading->pool;
    bool is_known;

    if (strcmp(key, "launcher") == 0) return read_launcher(pool, value, error);
    if (strcmp(key, "nodes") == 0) return read_nodes(pool, value, error);
    if (strcmp(key, "workers") == 0)
        return options_value_count(key, value, POOL_WORKER_LIMIT, &reading->worker_count, error);
    if (strcmp(key, "program") == 0) return read_text(&reading->program, value);
    if (strcmp(key, "command") == 0) return read_text(&reading->command, value);
    if (strcmp(key, "ssh-config") == 0) return read_ssh_config(reading, value, error);
    if (strcmp(key, "backend") == 0) return options_value_backend(value, &pool->backend, error);
    if (strcmp(key, "threads") == 0) return options_value_count(key, value, 1024, &pool->thread_count, error);
    if (strcmp(key, "worker-memory") == 0) return options_value_memory(key, value, &pool->memory_bytes, error);
    if (strcmp(key, "heartbeat") == 0) return options_value_seconds(key, value, 1, &pool->heartbeat_ms, error);
    if (strcmp(key, "landlock") == 0) return read_landlock(pool, value, error);
    if (strcmp(key, "tags") == 0) return pool_terms_read_tags(&pool->terms, value, error);
    if (strcmp(key, "users") == 0) return pool_terms_read_users(&pool->terms, value, error);
    if (!slurm_options_read(&pool->slurm, key, value, &is_known, error)) return false;
    if (is_known) {
        snprintf(reading->slurm_key, sizeof reading->slurm_key, "%s", key);
        return true;
    }
    error_set(error,
              "%s: expected launcher, nodes, workers, program, command, ssh-config, backend, threads, worker-memory, "
              "heartbeat, landlock, tags, users, or for Slurm %s",
              key, slurm_options_keys);
    return false;
}

// A shell on the node reads the words that ssh sends.
static bool is_plain_path(const char *path)
{
    for (; *path; path++)
        if (!isalnum((unsigned char)*path) && !strchr("-._/+", *path)) return false;
    return true;
}

static bool make_ssh_command(struct option_words *command, const struct reading *reading, const char *program,
                             struct error *error)
{
    static const char *const words[] = {"ssh", "-T", "-o", "BatchMode=yes", "-o", "ConnectTimeout=20"};

    if (!is_plain_path(program)) {
        error_set(error, "program: expected a path of letters, digits and -._/+, got \"%s\"", program);
        return false;
    }
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        option_words_add(command, xstrdup(words[i]));
    if (reading->ssh_config) {
        option_words_add(command, xstrdup("-F"));
        option_words_add(command, xstrdup(reading->ssh_config));
    }
    option_words_add(command, xstrdup("--"));
    option_words_add(command, xstrdup("{node}"));
    option_words_add(command, xstrdup(program));
    option_words_add(command, xstrdup("--node"));
    return true;
}

// "{node}" stands for the number of a Slurm job. The step waits until an earlier one of the daemon is gone. Without
// --unbuffered, which puts a terminal between, the node has pipes.
static void make_slurm_command(struct option_words *command, const struct pool_options *pool, const char *program)
{
    static const char *const words[] = {"srun",       "--jobid={node}", "--exact",    "--quiet",
                                        "--mpi=none", "--nodes=1",      "--ntasks=1", "--chdir=/"};

    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        option_words_add(command, xstrdup(words[i]));
    option_words_add(command, xasprintf("--cpus-per-task=%d", pool->slurm.cpu_count));
    option_words_add(command, xstrdup(program));
    option_words_add(command, xstrdup("--node"));
}

static bool make_command(struct reading *reading, struct error *error)
{
    const char *program = reading->program ? reading->program : "march-worker";
    struct option_words command = {0};
    bool ok;

    if (reading->pool->launcher != POOL_COMMAND && reading->command) {
        error_set(error, "command: expected with launcher=command only");
        return false;
    }
    if (reading->pool->launcher != POOL_SSH && reading->ssh_config) {
        error_set(error, "ssh-config: expected with launcher=ssh only");
        return false;
    }
    if (reading->pool->launcher == POOL_COMMAND && !reading->command) {
        error_set(error, "expected command=\"PROGRAM ... {node} ...\", or launcher=ssh or slurm");
        return false;
    }
    if (reading->command) {
        ok = option_words_split(&command, reading->command, error);
    } else if (reading->pool->launcher == POOL_SLURM) {
        make_slurm_command(&command, reading->pool, program);
        ok = true;
    } else {
        ok = make_ssh_command(&command, reading, program, error);
    }
    if (ok && command.count == 0) error_set(error, "command: expected a program");
    reading->pool->command = command.words;
    return ok && command.count > 0;
}

// A node for each allocation that there may be.
static bool make_slurm_nodes(struct reading *reading, struct error *error)
{
    struct pool_options *pool = reading->pool;

    if (pool->node_count > 0) {
        error_set(error, "nodes: expected max=COUNT with launcher=slurm, which chooses the machines");
        return false;
    }
    if (!slurm_options_check(&pool->slurm, error)) return false;
    if (pool->slurm.cpu_count == 0)
        pool->slurm.cpu_count = reading->worker_count * (pool->thread_count ? pool->thread_count : 1);
    pool->nodes = xcalloc((size_t)pool->slurm.max, sizeof pool->nodes[0]);
    for (int i = 0; i < pool->slurm.max; i++)
        pool->nodes[pool->node_count++] = (struct pool_node){.name = xasprintf("%s.%d", pool->name, i + 1)};
    return true;
}

static bool put_together(struct reading *reading, struct error *error)
{
    struct pool_options *pool = reading->pool;

    if (pool->launcher != POOL_SLURM && reading->slurm_key[0]) {
        error_set(error, "%s: expected with launcher=slurm only", reading->slurm_key);
        return false;
    }
    if (pool->launcher == POOL_SLURM && !make_slurm_nodes(reading, error)) return false;
    if (pool->node_count == 0) {
        error_set(error, "expected nodes=NAME,NAME=WORKERS,...");
        return false;
    }
    for (size_t i = 0; i < pool->node_count; i++)
        if (pool->nodes[i].worker_count == 0) pool->nodes[i].worker_count = reading->worker_count;
    return make_command(reading, error);
}

static bool read_words(struct reading *reading, char **words, struct error *error)
{
    for (size_t i = 1; words[i]; i++) {
        char *equals = strchr(words[i], '=');

        if (!equals) {
            error_set(error, "expected KEY=VALUE, got \"%s\"", words[i]);
            return false;
        }
        *equals = '\0';
        if (!read_setting(reading, words[i], equals + 1, error)) return false;
    }
    return put_together(reading, error);
}

static bool is_term(const char *word)
{
    return strncmp(word, "tags=", 5) == 0 || strncmp(word, "users=", 6) == 0;
}

static char *format_text(char **words)
{
    char *text = xstrdup("");

    for (size_t i = 0; words && words[i]; i++) {
        char *longer = is_term(words[i]) ? xstrdup(text) : xasprintf("%s\n%s", text, words[i]);

        free(text);
        text = longer;
    }
    return text;
}

bool pool_options_read(struct pool_options *pool, const char *text, struct error *error)
{
    struct reading reading = {.pool = pool, .worker_count = 1};
    struct option_words words = {0};
    bool ok = option_words_split(&words, text, error);

    *pool = (struct pool_options){.launcher = POOL_COMMAND, .heartbeat_ms = 30000, .wants_landlock = true};
    slurm_options_init(&pool->slurm);
    if (ok && (words.count == 0 || !schedule_is_pool_name(words.words[0]))) {
        error_set(error, "expected the pool's name and KEY=VALUE ...");
        ok = false;
    } else if (ok) {
        pool->name = xstrdup(words.words[0]);
        pool->text = format_text(words.words);
        ok = read_words(&reading, words.words, error);
        if (!ok) error_prefix(error, "%s", pool->name);
    }
    if (!ok) error_prefix(error, "--pool");
    pool_options_free_command(words.words);
    free(reading.program);
    free(reading.command);
    free(reading.ssh_config);
    if (!ok) pool_options_finish(pool);
    return ok;
}

void pool_options_finish(struct pool_options *pool)
{
    for (size_t i = 0; i < pool->node_count; i++)
        free(pool->nodes[i].name);
    free(pool->nodes);
    free(pool->name);
    free(pool->backend);
    free(pool->text);
    pool_terms_finish(&pool->terms);
    pool_options_free_command(pool->command);
    slurm_options_finish(&pool->slurm);
    *pool = (struct pool_options){0};
}

int pool_options_worker_count(const struct pool_options *pool)
{
    int count = 0;

    for (size_t i = 0; i < pool->node_count; i++)
        count += pool->nodes[i].worker_count;
    return count;
}

static char *put_node_in(const char *word, const char *node)
{
    const char *place = strstr(word, "{node}");

    if (!place) return xstrdup(word);
    return xasprintf("%.*s%s%s", (int)(place - word), word, node, place + strlen("{node}"));
}

char **pool_options_format_command(const struct pool_options *pool, const char *node)
{
    struct option_words command = {0};

    for (size_t i = 0; pool->command[i]; i++)
        option_words_add(&command, put_node_in(pool->command[i], node));
    return command.words;
}

static bool read_local_terms(struct pool_terms *terms, char **words, struct error *error)
{
    bool ok = true;

    for (size_t i = 1; words[i]; i++) {
        if (strncmp(words[i], "tags=", 5) == 0)
            ok = pool_terms_read_tags(terms, words[i] + 5, error);
        else if (strncmp(words[i], "users=", 6) == 0)
            ok = pool_terms_read_users(terms, words[i] + 6, error);
        else
            error_set(error, "expected tags=... or users=..., got \"%s\"", words[i]);
        if (!ok || !is_term(words[i])) return false;
    }
    return true;
}

// `*is_local`: the setting is about the pool "local".
static bool read_local(struct pool_table *table, const char *text, bool *is_local, struct error *error)
{
    struct option_words words = {0};
    bool ok = true;

    *is_local = option_words_split(&words, text, NULL) && words.count > 0 && strcmp(words.words[0], POOL_LOCAL) == 0;
    if (*is_local) {
        pool_terms_finish(&table->local);
        ok = read_local_terms(&table->local, words.words, error);
        if (!ok) error_prefix(error, "--pool: " POOL_LOCAL);
    }
    pool_options_free_command(words.words);
    return ok;
}

bool pool_table_add(struct pool_table *table, const char *text, struct error *error)
{
    struct pool_options pool;
    bool is_local;
    int workers;

    if (!read_local(table, text, &is_local, error)) return false;
    if (is_local) return true;
    if (table->count == POOL_LIMIT) {
        error_set(error, "--pool: expected at most %d pools", POOL_LIMIT);
        return false;
    }
    if (!pool_options_read(&pool, text, error)) return false;
    workers = pool_options_worker_count(&pool);
    for (size_t i = 0; i < table->count; i++) {
        workers += pool_options_worker_count(&table->pools[i]);
        if (strcmp(table->pools[i].name, pool.name) != 0) continue;
        error_set(error, "--pool: there is a pool %s already", pool.name);
        pool_options_finish(&pool);
        return false;
    }
    if (workers > POOL_TABLE_WORKER_LIMIT) {
        error_set(error, "--pool: expected at most %d workers of all pools, got %d", POOL_TABLE_WORKER_LIMIT, workers);
        pool_options_finish(&pool);
        return false;
    }
    table->pools = xgrow(table->pools, &table->capacity, table->count + 1, sizeof table->pools[0]);
    table->pools[table->count++] = pool;
    return true;
}

void pool_table_finish(struct pool_table *table)
{
    for (size_t i = 0; i < table->count; i++)
        pool_options_finish(&table->pools[i]);
    free(table->pools);
    pool_terms_finish(&table->local);
    *table = (struct pool_table){0};
}

bool pool_table_is_same(const struct pool_table *a, const struct pool_table *b)
{
    if (a->count != b->count) return false;
    for (size_t i = 0; i < a->count; i++)
        if (strcmp(a->pools[i].text, b->pools[i].text) != 0) return false;
    return true;
}

static bool swap_terms(struct pool_terms *a, struct pool_terms *b)
{
    struct pool_terms before = *a;

    *a = *b;
    *b = before;
    return !pool_terms_are_same(a, b);
}

bool pool_table_swap_terms(struct pool_table *table, struct pool_table *other)
{
    bool differ = swap_terms(&table->local, &other->local);

    for (size_t i = 0; i < table->count; i++)
        for (size_t k = 0; k < other->count; k++)
            if (strcmp(table->pools[i].name, other->pools[k].name) == 0)
                differ |= swap_terms(&table->pools[i].terms, &other->pools[k].terms);
    return differ;
}
