// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/farm/follow.h"
#include "cli/peer/connection.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "core/base/alloc.h"
#include "core/json/json_write.h"

#include <stdlib.h>

enum exit_status command_watch(const struct options *options, struct error *error)
{
    int64_t *ids = xcalloc(options->operand_count, sizeof *ids);
    const struct follow_params params = {.ids = ids,
                                         .id_count = options->operand_count,
                                         .shows_progress = !options->json,
                                         .prints_events = options->json,
                                         .options = options};
    struct connection *connection = NULL;
    enum exit_status status = EXIT_STATUS_USAGE;

    for (size_t i = 0; i < options->operand_count; i++)
        if (!options_parse_id(options->operands[i], &ids[i], error)) goto out;
    connection = daemon_call_connect(options, &status, error);
    if (connection) status = follow_jobs(&connection, &params, error);
out:
    connection_close(connection);
    free(ids);
    return status;
}

enum exit_status command_wait(const struct options *options, struct error *error)
{
    int64_t *ids = xcalloc(options->operand_count, sizeof *ids);
    struct json_writer jobs = {0};
    const struct follow_params params = {.ids = ids,
                                         .id_count = options->operand_count,
                                         .jobs = options->json ? &jobs : NULL,
                                         .ends = options->json ? NULL : stdout,
                                         .options = options};
    struct connection *connection = NULL;
    enum exit_status status = EXIT_STATUS_USAGE;

    for (size_t i = 0; i < options->operand_count; i++)
        if (!options_parse_id(options->operands[i], &ids[i], error)) goto out;
    connection = daemon_call_connect(options, &status, error);
    if (connection) status = follow_jobs(&connection, &params, error);
    if (jobs.text) print_json_text(&jobs);
out:
    connection_close(connection);
    json_writer_finish(&jobs);
    free(ids);
    return status;
}
