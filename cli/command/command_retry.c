// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/farm/job_states.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "core/json/json_write.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static void tell(const struct options *options, int64_t id, int64_t count)
{
    bool may_skip = options->state && (strstr(options->state, "succeeded") || strstr(options->state, "skipped"));

    printf("job %" PRId64 ": %" PRId64 " frame%s queued again\n", id, count, count == 1 ? "" : "s");
    if (count == 0 && !options->state)
        fprintf(stderr, "no frame has failed; --state succeeded,skipped,canceled means others\n");
    if (count > 0 && may_skip && !options->force)
        fprintf(stderr, "those whose files are whole and of this job will be skipped; --force renders them too\n");
}

enum exit_status command_retry(const struct options *options, struct error *error)
{
    struct json_writer params = {0};
    struct json_node retried;
    struct message reply;
    enum exit_status status;
    int64_t id, count = 0;

    if (!options_parse_id(options->operands[0], &id, error)) return EXIT_STATUS_USAGE;
    json_write_begin_object(&params);
    json_write_integer_member(&params, "id", id);
    job_states_write(&params, options->state);
    if (options->force) json_write_bool_member(&params, "force", true);
    if (options->range) json_write_string_member(&params, "range", options->range);
    json_write_end_object(&params);
    status = daemon_call(options, "job.retry", params.text, &reply, error);
    json_writer_finish(&params);
    if (status != EXIT_STATUS_DONE) return status;
    retried = json_node_child(&reply.body, "retried");
    if (!json_read_integer(&retried, 0, INT64_MAX / 1024, &count, error))
        status = EXIT_STATUS_FAILED;
    else if (options->json)
        print_json(&reply.body);
    else
        tell(options, id, count);
    message_finish(&reply);
    return status;
}
