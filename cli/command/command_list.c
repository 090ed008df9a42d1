// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/farm/job_pages.h"
#include "cli/farm/job_report.h"
#include "cli/peer/connection.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "cli/terminal/progress.h"
#include "cli/terminal/table.h"
#include "core/json/json_read.h"

#include <inttypes.h>
#include <stdio.h>
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

// What is listed, as rows or as JSON.
struct listing {
    struct table table;
    bool prints_json;
    int64_t count;
};

static bool on_job(void *user, const struct json_node *job, struct error *error)
{
    struct listing *listing = user;
    struct job_report report;

    if (listing->prints_json) {
        char *text = json_node_format(job);

        printf("%s%s", listing->count++ > 0 ? "," : "{\"jobs\":[", text);
        free(text);
        return true;
    }
    if (!job_report_read(&report, job, error)) return false;
    add_row(&listing->table, &report);
    job_report_finish(&report);
    return true;
}

// The result of job.list as one page.
static enum exit_status list_jobs(const struct job_pages *pages, struct connection *connection, struct error *error)
{
    struct listing *listing = pages->user;
    enum exit_status status;

    status = job_pages_read(pages, connection, error);
    if (status != EXIT_STATUS_DONE) return status;
    if (listing->prints_json)
        printf("%s],\"next\":null,\"total\":%" PRId64 "}\n", listing->count > 0 ? "" : "{\"jobs\":[", listing->count);
    else
        print_table(&listing->table);
    return status;
}

enum exit_status command_list(const struct options *options, struct error *error)
{
    struct listing listing = {.table = {.columns = columns, .column_count = sizeof columns / sizeof *columns},
                              .prints_json = options->json};
    struct job_pages pages = {.states = options->state,
                              .owner = options->owner,
                              .name = options->name,
                              .since_s = options->since_s,
                              .limit = options->limit,
                              .on_job = on_job,
                              .user = &listing};
    enum exit_status status;
    struct connection *connection = daemon_call_connect(options, &status, error);

    if (!connection) return status;
    status = list_jobs(&pages, connection, error);
    connection_close(connection);
    table_finish(&listing.table);
    return status;
}
