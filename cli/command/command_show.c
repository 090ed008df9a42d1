// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/farm/job_report.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "cli/terminal/progress.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static void print_time(const char *name, double unix_seconds)
{
    char text[PRINT_TIME_SIZE];

    if (unix_seconds < 0) return;
    print_format_time(unix_seconds, text);
    printf("%-10s %s\n", name, text);
}

static void print_text(const char *name, const char *text)
{
    if (text) printf("%-10s %s\n", name, text);
}

static void print_counts(const struct job_report *job)
{
    const struct {
        const char *name;
        int64_t count;
    } counts[] = {{"queued", job->queued},
                  {"running", job->running},
                  {"succeeded", job->succeeded},
                  {"skipped", job->skipped},
                  {"canceled", job->canceled},
                  {"failed", job->failed},
                  {"over the tolerance", job->missed}};
    const char *separator = ": ";

    printf("%-10s %" PRId64, "frames", job->frames);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        if (counts[i].count == 0) continue;
        printf("%s%" PRId64 " %s", separator, counts[i].count, counts[i].name);
        separator = ", ";
    }
    printf("\n");
}

static void print_job(const struct job_report *job)
{
    printf("%-10s %" PRId64 "\n", "id", job->id);
    print_text("name", job->name);
    print_text("comment", job->comment);
    print_text("tags", job->tags);
    print_text("state", job->state);
    if (job->phase && job->phase_progress > 0)
        printf("%-10s %s, %.0f %% of it\n", "phase", job->phase, 100 * job->phase_progress);
    else
        print_text("phase", job->phase);
    print_text("reason", job->reason);
    if (job->is_draft) print_text("quality", "draft, of no promised accuracy");
    print_text("range", job->range);
    print_counts(job);
    print_text("output", job->output);
    print_text("owner", job->owner);
    printf("%-10s %" PRId64 "\n", "priority", job->priority);
    print_text("pool", job->pool);
    print_time("submitted", job->submitted);
    print_time("started", job->started);
    print_time("finished", job->finished);
    if (job->seconds_per_frame >= 0) {
        char *pace = progress_format_pace(job->seconds_per_frame);

        printf("%-10s %s\n", "s/frame", pace);
        free(pace);
    }
    if (job->eta_s >= 0 && !job_report_has_ended(job)) {
        char *eta = progress_format_duration(job->eta_s);

        print_text("eta", eta);
        free(eta);
    }
}

enum exit_status command_show(const struct options *options, struct error *error)
{
    struct job_report report = {0};
    struct message reply;
    enum exit_status status;
    char params[64];
    int64_t id;

    if (!options_parse_id(options->operands[0], &id, error)) return EXIT_STATUS_USAGE;
    snprintf(params, sizeof params, "{\"id\":%" PRId64 "}", id);
    status = daemon_call(options, "job.show", params, &reply, error);
    if (status != EXIT_STATUS_DONE) return status;
    if (options->json)
        print_json(&reply.body);
    else if (job_report_read(&report, &reply.body, error))
        print_job(&report);
    else
        status = EXIT_STATUS_FAILED;
    job_report_finish(&report);
    message_finish(&reply);
    return status;
}
