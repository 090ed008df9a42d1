// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/command/completion.h"
#include "cli/command/completion_scripts.h"
#include "cli/farm/daemon_call.h"
#include "cli/farm/job_report.h"
#include "cli/program/options.h"
#include "core/base/error.h"
#include "core/json/json_read.h"

#include <inttypes.h>
#include <string.h>
#include <unistd.h>

// The params of job.list: some verbs make no sense for jobs that have ended, and nobody reads more than the newest.
static const char *states_of_verb(const char *verb)
{
    static const char *const names[] = {"watch", "wait", "pause", "resume", "cancel", "prio"};

    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(names[i], verb) == 0)
            return "{\"state\":[\"queued\",\"running\",\"paused\"],\"order\":\"-id\",\"limit\":200}";
    return "{\"order\":\"-id\",\"limit\":200}";
}

// Prints no error, and is ended by SIGALRM when the daemon hangs: the user is waiting for a key to have an effect.
static void write_ids(FILE *out, const char *verb)
{
    const struct options options = {.socket = NULL};
    struct json_node jobs, job = {0};
    struct message reply;

    alarm(1);
    if (daemon_call(&options, "job.list", states_of_verb(verb), &reply, NULL) != EXIT_STATUS_DONE) return;
    jobs = json_node_child(&reply.body, "jobs");
    while (json_node_next(&jobs, &job)) {
        struct job_report report;

        if (!job_report_read(&report, &job, NULL)) break;
        fprintf(out, "%" PRId64 "\t%s, %s\n", report.id, report.name, report.state);
        job_report_finish(&report);
    }
    message_finish(&reply);
}

enum exit_status command_completion(const struct options *options, struct error *error)
{
    const char *shell = options->operands[0];
    const char *script;

    // The scripts run: march completion words -- WORD...
    if (strcmp(shell, "words") == 0) {
        completion_write(stdout, options->operands + 1, options->operand_count - 1, write_ids);
        return EXIT_STATUS_DONE;
    }
    script = options->operand_count == 1 ? completion_script(shell) : NULL;
    if (!script) {
        error_set(error, "expected bash, zsh or fish, got \"%s\"", options->operands[options->operand_count - 1]);
        return EXIT_STATUS_USAGE;
    }
    fputs(script, stdout);
    return EXIT_STATUS_DONE;
}
