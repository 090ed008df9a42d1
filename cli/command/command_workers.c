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
} shown[] = {{{"ID", true}, "id"},         {{"PID", true}, "pid"},
             {{"STATE", false}, "state"},  {{"BACKEND", false}, "backend"},
             {{"JOB", true}, "job"},       {{"FRAMES", false}, "frames"},
             {{"DONE", true}, "done"},     {{"RENDERER", false}, "renderer"},
             {{"REASON", false}, "reason"}};

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

enum exit_status command_workers(const struct options *options, struct error *error)
{
    struct table_column columns[COLUMN_COUNT];
    struct table table = {.columns = columns, .column_count = COLUMN_COUNT};
    struct json_node workers, worker = {0};
    struct message reply;
    enum exit_status status = daemon_call(options, "worker.list", NULL, &reply, error);

    if (status != EXIT_STATUS_DONE) return status;
    if (options->json) {
        print_json(&reply.body);
    } else {
        for (size_t i = 0; i < COLUMN_COUNT; i++)
            columns[i] = shown[i].column;
        workers = json_node_child(&reply.body, "workers");
        while (json_node_next(&workers, &worker))
            for (size_t i = 0; i < COLUMN_COUNT; i++)
                add_cell(&table, &worker, shown[i].key);
        print_table(&table);
        table_finish(&table);
    }
    message_finish(&reply);
    return status;
}
