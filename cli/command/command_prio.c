// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/farm/job_report.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "core/base/error.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum exit_status command_prio(const struct options *options, struct error *error)
{
    const char *text = options->operands[1];
    size_t digits = strspn(text, "0123456789");
    struct job_report report = {0};
    struct message reply;
    enum exit_status status;
    char params[96];
    int64_t id;

    if (!options_parse_id(options->operands[0], &id, error)) return EXIT_STATUS_USAGE;
    if (digits == 0 || digits > 3 || text[digits] || atoi(text) > 200) {
        error_set(error, "expected a priority in [0, 200], got \"%s\"", text);
        return EXIT_STATUS_USAGE;
    }
    snprintf(params, sizeof params, "{\"id\":%" PRId64 ",\"priority\":%d}", id, atoi(text));
    status = daemon_call(options, "job.priority", params, &reply, error);
    if (status != EXIT_STATUS_DONE) return status;
    if (options->json)
        print_json(&reply.body);
    else if (job_report_read(&report, &reply.body, error))
        printf("job %" PRId64 ": priority %" PRId64 "\n", id, report.priority);
    job_report_finish(&report);
    message_finish(&reply);
    return error->message[0] ? EXIT_STATUS_FAILED : EXIT_STATUS_DONE;
}
