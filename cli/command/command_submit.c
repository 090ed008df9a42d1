// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/farm/follow.h"
#include "cli/farm/job_report.h"
#include "cli/job/job_document.h"
#include "cli/job/job_notify_set.h"
#include "cli/job/job_summary.h"
#include "cli/job/json_set.h"
#include "cli/peer/connection.h"
#include "cli/program/options.h"
#include "cli/render/plan_report.h"
#include "cli/terminal/print.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char *load_document(const struct options *options, struct error *error)
{
    char *document = job_document_load(options->operands[0], options->sets, options->set_count, error);
    char *assignment, *edited;

    if (document && options->draft && !json_set_text(&document, "quality", "draft", error)) {
        free(document);
        return NULL;
    }
    if (document && options->pool && !json_set_text(&document, "pool", options->pool, error)) {
        free(document);
        return NULL;
    }
    if (document && options->range && !json_set_text(&document, "frames", options->range, error)) {
        free(document);
        return NULL;
    }
    if (document && options->notify && !job_notify_set(&document, options->notify, error)) {
        free(document);
        return NULL;
    }
    if (!document || options->priority < 0) return document;
    assignment = xasprintf("priority=%" PRId64, options->priority);
    edited = json_set(document, assignment, error);
    free(assignment);
    free(document);
    return edited;
}

static void print_plan(const struct options *options, const struct job *job, const struct json_node *plan)
{
    struct json_writer writer = {0};

    if (!options->json) {
        job_summary_print(job);
        if (plan) plan_report_print(plan);
        return;
    }
    json_write_begin_object(&writer);
    json_write_bool_member(&writer, "dry_run", true);
    job_summary_write_members(job, &writer);
    if (plan) {
        char *text = json_node_format(plan);

        json_write_key(&writer, "plan");
        json_write_raw(&writer, text, strlen(text));
        free(text);
    }
    json_write_end_object(&writer);
    print_json_text(&writer);
    json_writer_finish(&writer);
}

// Prints the plan of a job with a tolerance; others need none.
static enum exit_status show_plan(const struct options *options, const struct job *job, const char *document,
                                  struct error *error)
{
    enum exit_status status;
    struct message reply;

    if (job->quality.method != JOB_METHOD_AUTO) {
        print_plan(options, job, NULL);
        return EXIT_STATUS_DONE;
    }
    status = plan_report_ask(options, document, &reply, error);
    if (status != EXIT_STATUS_DONE) return status;
    print_plan(options, job, &reply.body);
    message_finish(&reply);
    return EXIT_STATUS_DONE;
}

// What the daemon could not check; the job is taken all the same.
static void print_warnings(const struct json_node *result)
{
    struct json_node warnings = json_node_child(result, "warnings"), warning = {0};
    const char *text;

    while (json_node_type(&warnings) == JSON_ARRAY && json_node_next(&warnings, &warning))
        if (json_read_string(&warning, &text, NULL)) fprintf(stderr, "warning: %s\n", text);
}

static bool send_document(const struct options *options, struct connection *connection, const char *document,
                          int64_t *id, struct error *error)
{
    struct json_writer params = {0};
    struct json_node node;
    struct message reply;
    bool ok;

    json_write_begin_object(&params);
    json_write_key(&params, "document");
    json_write_raw(&params, document, strlen(document));
    json_write_bool_member(&params, "paused", options->paused);
    json_write_end_object(&params);
    ok = connection_call(connection, "job.submit", params.text, &reply, error);
    json_writer_finish(&params);
    if (!ok) {
        error_prefix(error, "%s", job_document_name(options->operands[0]));
        return false;
    }
    node = json_node_child(&reply.body, "id");
    ok = json_read_integer(&node, 1, INT64_C(1) << 52, id, error);
    if (!options->json) print_warnings(&reply.body);
    message_finish(&reply);
    return ok;
}

// The job is on disk, so failures here are not failures of the submission.
static void tell_job(struct connection *connection, int64_t id)
{
    struct job_report report = {0};
    struct message reply;
    char params[64];

    snprintf(params, sizeof params, "{\"id\":%" PRId64 "}", id);
    if (!connection_call(connection, "job.show", params, &reply, NULL)) return;
    if (job_report_read(&report, &reply.body, NULL)) {
        const char *reason = job_report_is_next(&report) ? NULL : report.reason;

        fprintf(stderr, "job %" PRId64 ": %" PRId64 " frame%s to %s%s%s\n", id, report.frames,
                report.frames == 1 ? "" : "s", report.output ? report.output : "?", reason ? "; " : "",
                reason ? reason : "");
    }
    job_report_finish(&report);
    message_finish(&reply);
}

static enum exit_status follow_submitted(const struct options *options, struct connection **connection, int64_t id,
                                         struct error *error)
{
    struct json_writer jobs = {0};
    bool wants_jobs = options->json && !options->watch;
    const struct follow_params params = {.ids = &id,
                                         .id_count = 1,
                                         .shows_progress = options->watch && !options->json,
                                         .prints_events = options->watch && options->json,
                                         .jobs = wants_jobs ? &jobs : NULL,
                                         .ends = options->json || options->watch ? NULL : stderr,
                                         .options = options};
    enum exit_status status = follow_jobs(connection, &params, error);

    if (jobs.text) print_json_text(&jobs);
    json_writer_finish(&jobs);
    return status;
}

static enum exit_status submit(const struct options *options, const char *document, struct error *error)
{
    enum exit_status status;
    struct connection *connection = daemon_call_connect(options, &status, error);
    int64_t id = 0;

    if (!connection) return status;
    status = EXIT_STATUS_DONE;
    if (!send_document(options, connection, document, &id, error)) {
        status = connection_failure(connection);
        goto out;
    }
    if (!options->json)
        printf("%" PRId64 "\n", id);
    else if (options->watch || !options->wait)
        printf("{\"id\":%" PRId64 "}\n", id);
    fflush(stdout);
    if (!options->json) tell_job(connection, id);
    if (options->wait || options->watch) status = follow_submitted(options, &connection, id, error);
out:
    connection_close(connection);
    return status;
}

enum exit_status command_submit(const struct options *options, struct error *error)
{
    char *document = load_document(options, error);
    enum exit_status status = EXIT_STATUS_USAGE;
    struct job job = {0};

    if (!document || !job_document_check(options->operands[0], document, "/", &job, error)) goto out;
    status = options->dry_run ? show_plan(options, &job, document, error) : submit(options, document, error);
out:
    job_finish(&job);
    free(document);
    return status;
}
