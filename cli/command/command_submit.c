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
#include "cli/render/beyond_report.h"
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

// Replaces a member of the document; on failure the document is freed and NULL.
static char *assign(char *document, const char *key, const char *value, struct error *error)
{
    char *assignment = xasprintf("%s=%s", key, value), *edited = json_set(document, assignment, error);

    free(assignment);
    free(document);
    return edited;
}

// "3,4" as "[3,4]", owned by the caller; NULL and an error where it is no list of ids.
static char *format_after(const char *ids, struct error *error)
{
    char *rest = xstrdup(ids), *at = rest, *text;
    bool ok = true;

    for (char *id = strsep(&at, ","); ok && id; id = strsep(&at, ",")) {
        int64_t number;

        ok = options_parse_id(id, &number, error);
    }
    free(rest);
    if (!ok) error_prefix(error, "--after");
    text = ok ? xasprintf("[%s]", ids) : NULL;
    return text;
}

static char *apply_options(const struct options *options, char *document, struct error *error)
{
    char number[24], *after;

    if (document && options->draft && !json_set_text(&document, "quality", "draft", error)) goto fail;
    if (document && options->pool && !json_set_text(&document, "pool", options->pool, error)) goto fail;
    if (document && options->range && !json_set_text(&document, "frames", options->range, error)) goto fail;
    if (document && options->notify && !job_notify_set(&document, options->notify, error)) goto fail;
    snprintf(number, sizeof number, "%" PRId64, options->priority);
    if (document && options->priority >= 0) document = assign(document, "priority", number, error);
    if (!document || !options->after) return document;
    after = format_after(options->after, error);
    if (!after) goto fail;
    document = assign(document, "after", after, error);
    free(after);
    return document;
fail:
    free(document);
    return NULL;
}

// A job that is to be submitted. The zero value is empty.
struct submission {
    const char *path; // borrowed
    char *document;   // owned
    struct job job;
};

static bool load_submission(struct submission *submission, const struct options *options, const char *path,
                            struct error *error)
{
    submission->path = path;
    submission->document =
        apply_options(options, job_document_load(path, options->sets, options->set_count, error), error);
    return submission->document && job_document_check(path, submission->document, "/", &submission->job, error);
}

static void finish_submissions(struct submission *submissions, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        job_finish(&submissions[i].job);
        free(submissions[i].document);
    }
    free(submissions);
}

static void print_plan(const struct options *options, const struct job *job, const struct json_node *plan)
{
    struct json_writer writer = {0};

    if (!options->json) {
        job_summary_print(job);
        if (plan) plan_report_print(plan, job->scene.orders);
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
    struct job_beyond beyond;
    enum exit_status status;
    struct message reply;

    if (job->quality.method != JOB_METHOD_AUTO) {
        print_plan(options, job, NULL);
        return EXIT_STATUS_DONE;
    }
    status = plan_report_ask(options, document, &reply, error);
    if (status != EXIT_STATUS_DONE) return status;
    print_plan(options, job, &reply.body);
    plan_report_find_beyond(&reply.body, &beyond);
    beyond_report_warn(&beyond, job);
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

static bool send_document(const struct options *options, struct connection *connection,
                          const struct submission *submission, int64_t *id, struct error *error)
{
    struct json_writer params = {0};
    struct json_node node;
    struct message reply;
    bool ok;

    json_write_begin_object(&params);
    json_write_key(&params, "document");
    json_write_raw(&params, submission->document, strlen(submission->document));
    json_write_bool_member(&params, "paused", options->paused);
    json_write_end_object(&params);
    ok = connection_call(connection, "job.submit", params.text, &reply, error);
    json_writer_finish(&params);
    if (!ok) {
        error_prefix(error, "%s", job_document_name(submission->path));
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

static enum exit_status follow_submitted(const struct options *options, struct connection **connection,
                                         const int64_t *ids, size_t count, struct error *error)
{
    struct json_writer jobs = {0};
    bool wants_jobs = options->json && !options->watch;
    const struct follow_params params = {.ids = ids,
                                         .id_count = count,
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

static void print_ids(const struct options *options, const int64_t *ids, size_t count)
{
    if (!options->json) {
        printf("%" PRId64 "\n", ids[count - 1]);
    } else if (!options->chain) {
        printf("{\"id\":%" PRId64 "}\n", ids[0]);
    } else {
        for (size_t i = 0; i < count; i++)
            printf("%s%" PRId64, i > 0 ? "," : "{\"ids\":[", ids[i]);
        printf("]}\n");
    }
    fflush(stdout);
}

// What was submitted before a refusal stays in the queue.
static void tell_submitted(const struct submission *submissions, const int64_t *ids, size_t count, struct error *error)
{
    struct error cause = *error;
    char *list = xstrdup("");

    for (size_t i = 0; i < count; i++) {
        char *longer =
            xasprintf("%s%s%" PRId64 " (%s)", list, i > 0 ? ", " : "", ids[i], job_document_name(submissions[i].path));

        free(list);
        list = longer;
    }
    if (count > 0) error_set(error, "%s; submitted before it: %s", cause.message, list);
    free(list);
}

// The job is in the queue by then: nothing waits for it.
static void warn_of_beyond(const struct options *options, const struct submission *submission)
{
    struct job_beyond beyond;

    if (options->json || submission->job.quality.method != JOB_METHOD_AUTO) return;
    beyond_report_ask(options, &submission->job, submission->document, &beyond);
    beyond_report_warn(&beyond, &submission->job);
}

// Each of a chain comes after the one before.
static bool submit_one(const struct options *options, struct connection *connection, struct submission *submission,
                       const int64_t *before, int64_t *id, struct error *error)
{
    char after[32];

    if (before) {
        snprintf(after, sizeof after, "[%" PRId64 "]", *before);
        submission->document = assign(submission->document, "after", after, error);
    }
    return submission->document && send_document(options, connection, submission, id, error);
}

static enum exit_status submit(const struct options *options, struct submission *submissions, size_t count,
                               struct error *error)
{
    enum exit_status status;
    struct connection *connection = daemon_call_connect(options, &status, error);
    int64_t *ids = xcalloc(count, sizeof *ids);

    if (!connection) goto out;
    status = EXIT_STATUS_DONE;
    for (size_t i = 0; i < count; i++) {
        if (!submit_one(options, connection, &submissions[i], i > 0 ? &ids[i - 1] : NULL, &ids[i], error)) {
            status = connection_failure(connection);
            tell_submitted(submissions, ids, i, error);
            goto out;
        }
        if (options->json) continue;
        print_ids(options, ids, i + 1);
        tell_job(connection, ids[i]);
    }
    if (options->json && (options->watch || !options->wait)) print_ids(options, ids, count);
    for (size_t i = 0; i < count; i++)
        warn_of_beyond(options, &submissions[i]);
    if (options->wait || options->watch) status = follow_submitted(options, &connection, ids, count, error);
out:
    connection_close(connection);
    free(ids);
    return status;
}

static bool check_operands(const struct options *options, struct error *error)
{
    if (options->operand_count > 1 && !options->chain)
        error_set(error, "expected one job, or --chain for several, each after the one before");
    else if (options->operand_count > 1 && options->dry_run)
        error_set(error, "--dry-run: expected one job");
    else
        return true;
    return false;
}

// All are checked before the first is sent.
enum exit_status command_submit(const struct options *options, struct error *error)
{
    size_t count = options->operand_count;
    struct submission *submissions = xcalloc(count, sizeof *submissions);
    enum exit_status status = EXIT_STATUS_USAGE;
    bool ok = check_operands(options, error);

    for (size_t i = 0; i < count && ok; i++)
        ok = load_submission(&submissions[i], options, options->operands[i], error);
    if (ok && options->dry_run)
        status = show_plan(options, &submissions[0].job, submissions[0].document, error);
    else if (ok)
        status = submit(options, submissions, count, error);
    finish_submissions(submissions, count);
    return status;
}
