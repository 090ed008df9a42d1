// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "cli/terminal/table.h"

#include <stdlib.h>

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
        print_workers(&workers);
    }
    message_finish(&reply);
    return status;
}
