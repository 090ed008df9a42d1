// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "cli/terminal/table.h"
#include "core/base/alloc.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    struct table_column column;
    const char *key;
    bool is_of_nodes; // shown only where there are nodes
} shown[] = {{{"ID", true}, "id", false},
             {{"POOL", false}, "pool", true},
             {{"NODE", false}, "node", true},
             {{"PID", true}, "pid", false},
             {{"STATE", false}, "state", false},
             {{"BACKEND", false}, "backend", false},
             {{"JOB", true}, "job", false},
             {{"FRAMES", false}, "frames", false},
             {{"DONE", true}, "done", false},
             {{"RENDERER", false}, "renderer", false},
             {{"SANDBOX", false}, "sandbox", false},
             {{"REASON", false}, "reason", false}};

enum { COLUMN_COUNT = sizeof shown / sizeof *shown };

static void add_cell(struct table *table, const struct json_node *worker, const char *key)
{
    struct json_node node = json_node_child(worker, key);
    const char *text;
    char *json;

    switch (json_node_type(&node)) {
    case JSON_ABSENT:
    case JSON_NULL:
        table_add(table, NULL);
        return;
    case JSON_STRING:
        table_add(table, json_read_string(&node, &text, NULL) ? text : NULL);
        return;
    default:
        json = json_node_format(&node);
        table_add(table, json);
        free(json);
    }
}

static bool has_nodes(const struct json_node *workers)
{
    struct json_node worker = {0};

    while (json_node_next(workers, &worker)) {
        struct json_node node = json_node_child(&worker, "node");

        if (json_node_type(&node) == JSON_STRING) return true;
    }
    return false;
}

static void print_workers(const struct json_node *workers)
{
    bool shows_nodes = has_nodes(workers);
    struct table_column columns[COLUMN_COUNT];
    struct table table = {.columns = columns};
    struct json_node worker = {0};

    for (size_t i = 0; i < COLUMN_COUNT; i++)
        if (shows_nodes || !shown[i].is_of_nodes) columns[table.column_count++] = shown[i].column;
    while (json_node_next(workers, &worker))
        for (size_t i = 0; i < COLUMN_COUNT; i++)
            if (shows_nodes || !shown[i].is_of_nodes) add_cell(&table, &worker, shown[i].key);
    print_table(&table);
    table_finish(&table);
}

static const char *text_of(const struct json_node *worker, const char *key)
{
    struct json_node node = json_node_child(worker, key);
    const char *text;

    return json_read_string(&node, &text, NULL) ? text : "";
}

// The workers of one node, which follow one another, and of the daemon's machine.
struct node_summary {
    const char *pool, *node, *reason;        // borrowed; "": none
    char *states[8], *renderers, *sandboxes; // owned
    int counts[8];
    size_t state_count;
    int64_t done;
};

// Puts the text at the end of the owned list.
static void add_text(char **list, const char *text)
{
    char *longer = *list ? xasprintf("%s, %s", *list, text) : xstrdup(text);

    free(*list);
    *list = longer;
}

// Likewise, unless it is there.
static void note_text(char **list, const char *text)
{
    size_t length = strlen(text);

    if (length == 0) return;
    for (const char *at = *list; at && (at = strstr(at, text)); at += length)
        if ((at == *list || at[-1] == ' ') && (at[length] == '\0' || at[length] == ',')) return;
    add_text(list, text);
}

static void note_worker(struct node_summary *summary, const struct json_node *worker)
{
    struct json_node done = json_node_child(worker, "done");
    const char *state = text_of(worker, "state");
    int64_t count = 0;
    size_t i = 0;

    while (i < summary->state_count && strcmp(summary->states[i], state) != 0)
        i++;
    if (i == summary->state_count && i < sizeof summary->states / sizeof summary->states[0])
        summary->states[summary->state_count++] = xstrdup(state);
    if (i < summary->state_count) summary->counts[i]++;
    if (json_read_integer(&done, 0, INT64_MAX, &count, NULL)) summary->done += count;
    note_text(&summary->renderers, text_of(worker, "renderer"));
    note_text(&summary->sandboxes, text_of(worker, "sandbox"));
    if (!*summary->reason) summary->reason = text_of(worker, "reason");
}

// Adds the row, and empties the summary.
static void add_summary(struct table *table, struct node_summary *summary)
{
    char *states = NULL;

    for (size_t i = 0; i < summary->state_count; i++) {
        char *part = xasprintf("%d %s", summary->counts[i], summary->states[i]);

        add_text(&states, part);
        free(part);
        free(summary->states[i]);
    }
    table_add(table, summary->pool);
    table_add(table, *summary->node ? summary->node : NULL);
    table_add(table, states);
    table_add_format(table, "%" PRId64, summary->done);
    table_add(table, summary->renderers);
    table_add(table, summary->sandboxes);
    table_add(table, *summary->reason ? summary->reason : NULL);
    free(states);
    free(summary->renderers);
    free(summary->sandboxes);
}

static void print_nodes(const struct json_node *workers)
{
    static const struct table_column columns[] = {{"POOL", false},  {"NODE", false},     {"WORKERS", false},
                                                  {"DONE", true},   {"RENDERER", false}, {"SANDBOX", false},
                                                  {"REASON", false}};
    struct table table = {.columns = columns, .column_count = sizeof columns / sizeof columns[0]};
    struct node_summary summary = {0};
    struct json_node worker = {0};

    while (json_node_next(workers, &worker)) {
        const char *pool = text_of(&worker, "pool"), *node = text_of(&worker, "node");
        bool is_same = summary.pool && strcmp(pool, summary.pool) == 0 && strcmp(node, summary.node) == 0;

        if (!is_same) {
            if (summary.pool) add_summary(&table, &summary);
            summary = (struct node_summary){.pool = pool, .node = node, .reason = ""};
        }
        note_worker(&summary, &worker);
    }
    if (summary.pool) add_summary(&table, &summary);
    print_table(&table);
    table_finish(&table);
}

enum exit_status command_workers(const struct options *options, struct error *error)
{
    struct json_node workers;
    struct message reply;
    enum exit_status status = daemon_call(options, "worker.list", NULL, &reply, error);

    if (status != EXIT_STATUS_DONE) return status;
    if (options->json) {
        print_json(&reply.body);
    } else {
        workers = json_node_child(&reply.body, "workers");
        if (options->nodes)
            print_nodes(&workers);
        else
            print_workers(&workers);
    }
    message_finish(&reply);
    return status;
}
