// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/farm/job_report.h"
#include "cli/farm/job_states.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "cli/terminal/progress.h"
#include "cli/terminal/table.h"
#include "core/json/json_write.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static const struct table_column columns[] = {{"ID", true},     {"NAME", false},   {"STATE", false}, {"PHASE", false},
                                              {"PRIO", true},   {"DONE", true},    {"FRAMES", true}, {"FAILED", true},
                                              {"MISSED", true}, {"S/FRAME", true}, {"ETA", true},    {"OWNER", false},
                                              {"TAGS", false},  {"REASON", false}};

static void add_row(struct table *table, const struct job_report *job)
{
    char *eta = NULL, *pace = NULL;

    if (job->eta_s >= 0 && strcmp(job->state, "running") == 0) eta = progress_format_duration(job->eta_s);
    table_add_format(table, "%" PRId64, job->id);
    table_add(table, job->name);
    table_add(table, job->state);
    if (job->phase && job->phase_progress > 0)
        table_add_format(table, "%s %.0f %%", job->phase, 100 * job->phase_progress);
    else
        table_add(table, job->phase);
    table_add_format(table, "%" PRId64, job->priority);
    table_add_format(table, "%" PRId64, job->succeeded + job->skipped);
    table_add_format(table, "%" PRId64, job->frames);
    table_add_format(table, "%" PRId64, job->failed);
    table_add_format(table, "%" PRId64, job->missed);
    if (job->seconds_per_frame >= 0) pace = progress_format_pace(job->seconds_per_frame);
    table_add(table, pace);
    table_add(table, eta);
    table_add(table, job->owner);
    table_add(table, job->tags);
    table_add_format(table, "%s%s%s", job->is_draft ? "draft" : "", job->is_draft && job->reason ? "; " : "",
                     job->reason ? job->reason : "");
    free(pace);
    free(eta);
}

static bool print_jobs(const struct json_node *jobs, struct error *error)
{
    struct table table = {.columns = columns, .column_count = sizeof columns / sizeof *columns};
    struct json_node job = {0};
    bool ok = true;

    while (ok && json_node_next(jobs, &job)) {
        struct job_report report;

        ok = job_report_read(&report, &job, error);
        if (!ok) break;
        add_row(&table, &report);
        job_report_finish(&report);
    }
    if (ok) print_table(&table);
    table_finish(&table);
    return ok;
}

enum exit_status command_list(const struct options *options, struct error *error)
{
    struct json_writer params = {0};
    struct message reply;
    enum exit_status status;

    json_write_begin_object(&params);
    job_states_write(&params, options->state);
    json_write_end_object(&params);
    status = daemon_call(options, "job.list", params.text, &reply, error);
    json_writer_finish(&params);
    if (status != EXIT_STATUS_DONE) return status;
    if (options->json) {
        print_json(&reply.body);
    } else {
        struct json_node jobs = json_node_child(&reply.body, "jobs");

        if (!print_jobs(&jobs, error)) status = EXIT_STATUS_FAILED;
    }
    message_finish(&reply);
    return status;
}
