// SPDX-License-Identifier: Apache-2.0
#include "cli/farm/follow.h"

#include "cli/farm/daemon_call.h"
#include "cli/farm/job_report.h"
#include "cli/peer/connection.h"
#include "cli/program/interrupt.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "cli/terminal/progress.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_write.h"

#include <inttypes.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TICK_MS = 250, SHOWN_LIMIT = 16, ASK_MS = 1000, RECONNECT_DEFAULT_S = 300 };

struct followed {
    struct job_report report;
    char *json; // owned; the last state of the job
    char *told; // owned; the last reason to wait that was told; NULL: none
};

struct follow {
    const struct follow_params *params; // borrowed
    struct interrupt interrupt;
    int64_t asked_ms;      // when jobs that wait were last asked why
    int64_t lost_ms;       // when the daemon was lost; 0: it is there
    struct followed *jobs; // owned
    size_t count, capacity;
    struct progress_display display;
};

static bool is_wanted(const struct follow *follow, int64_t id)
{
    for (size_t i = 0; i < follow->params->id_count; i++)
        if (follow->params->ids[i] == id) return true;
    return follow->params->id_count == 0;
}

static struct followed *find_followed(struct follow *follow, int64_t id)
{
    for (size_t i = 0; i < follow->count; i++)
        if (follow->jobs[i].report.id == id) return &follow->jobs[i];
    return NULL;
}

// The job as in events, without the document that job.show adds.
static char *format_job(const struct json_node *job)
{
    struct json_writer writer = {0};
    struct json_node member = {0};

    json_write_begin_object(&writer);
    while (json_node_next(job, &member)) {
        char *text;

        if (strcmp(member.key, "document") == 0) continue;
        text = json_node_format(&member);
        json_write_key(&writer, member.key);
        json_write_raw(&writer, text, strlen(text));
        free(text);
    }
    json_write_end_object(&writer);
    return writer.text;
}

static bool waits(const struct job_report *report)
{
    return report->running == 0 && !job_report_has_ended(report);
}

static void tell_state(FILE *out, const struct job_report *report)
{
    char *state = progress_format_state(report->state, report->reason);

    fprintf(out, "job %" PRId64 ": %s\n", report->id, state);
    free(state);
}

// Whoever only waits is told at once why a job does not run.
static void tell_reason(const struct follow *follow, struct followed *followed)
{
    const struct job_report *report = &followed->report;
    const char *reason = waits(report) ? report->reason : NULL;

    if (!follow->params->ends || !reason || job_report_is_next(report)) return;
    if (followed->told && strcmp(followed->told, reason) == 0) return;
    free(followed->told);
    followed->told = xstrdup(reason);
    tell_state(stderr, report);
}

static bool note_job(struct follow *follow, const struct json_node *node, struct error *error)
{
    struct job_report report;
    struct followed *followed;

    if (!job_report_read(&report, node, error)) return false;
    if (!is_wanted(follow, report.id)) {
        job_report_finish(&report);
        return true;
    }
    followed = find_followed(follow, report.id);
    if (!followed) {
        follow->jobs = xgrow(follow->jobs, &follow->capacity, follow->count + 1, sizeof *follow->jobs);
        followed = &follow->jobs[follow->count++];
        memset(followed, 0, sizeof *followed);
    }
    job_report_finish(&followed->report);
    free(followed->json);
    followed->report = report;
    followed->json = format_job(node);
    tell_reason(follow, followed);
    return true;
}

static bool is_event_wanted(const struct follow *follow, const struct json_node *event)
{
    struct json_node job = json_node_child(event, "job");
    struct json_node id = json_node_child(json_node_type(&job) == JSON_OBJECT ? &job : event, "id");
    int64_t number;

    if (follow->params->id_count == 0) return true;
    return json_read_integer(&id, 1, INT64_C(1) << 52, &number, NULL) && is_wanted(follow, number);
}

static bool on_message(struct follow *follow, const struct message *message, struct error *error)
{
    struct json_node job;

    if (message->kind != MESSAGE_NOTIFICATION || strcmp(message->method, "event") != 0) return true;
    if (follow->params->prints_events && is_event_wanted(follow, &message->body)) print_json(&message->body);
    job = json_node_child(&message->body, "job");
    if (json_node_type(&job) != JSON_OBJECT) return true;
    return note_job(follow, &job, error);
}

static bool subscribe(struct follow *follow, struct connection *connection, struct error *error)
{
    struct json_writer params = {0};
    struct message reply;
    bool ok;

    json_write_begin_object(&params);
    if (follow->params->id_count == 1) json_write_integer_member(&params, "id", follow->params->ids[0]);
    json_write_bool_member(&params, "frames", follow->params->prints_events);
    json_write_end_object(&params);
    ok = connection_call(connection, "events.subscribe", params.text, &reply, error);
    if (ok) message_finish(&reply);
    json_writer_finish(&params);
    return ok;
}

static bool note_listed(struct follow *follow, struct message *reply, struct error *error)
{
    struct json_node jobs = json_node_child(&reply->body, "jobs"), job = {0};
    bool ok = true;

    while (ok && json_node_next(&jobs, &job))
        ok = note_job(follow, &job, error);
    message_finish(reply);
    return ok;
}

static bool ask_all(struct follow *follow, struct connection *connection, struct error *error)
{
    struct message reply;

    return connection_call(connection, "job.list", "{\"state\":[\"queued\",\"running\",\"paused\"]}", &reply, error) &&
           note_listed(follow, &reply, error);
}

// Reads the current states of the jobs; events report only changes.
static bool ask_jobs(struct follow *follow, struct connection *connection, struct error *error)
{
    if (follow->params->id_count == 0) return ask_all(follow, connection, error);
    for (size_t i = 0; i < follow->params->id_count; i++) {
        struct message reply;
        char params[64];
        bool ok;

        snprintf(params, sizeof params, "{\"id\":%" PRId64 "}", follow->params->ids[i]);
        if (!connection_call(connection, "job.show", params, &reply, error)) return false;
        ok = note_job(follow, &reply.body, error);
        message_finish(&reply);
        if (!ok) return false;
    }
    return true;
}

// Why a job waits may change without an event of its own, when another job does.
static bool ask_why(struct follow *follow, struct connection *connection, struct error *error)
{
    struct json_writer params = {0};
    struct message reply;
    size_t count = 0;
    bool ok = true;

    if (progress_now_ms() < follow->asked_ms + ASK_MS || (!follow->params->shows_progress && !follow->params->ends))
        return true;
    follow->asked_ms = progress_now_ms();
    json_write_begin_object(&params);
    json_write_key(&params, "ids");
    json_write_begin_array(&params);
    for (size_t i = 0; i < follow->count && count < SHOWN_LIMIT; i++)
        if (waits(&follow->jobs[i].report)) {
            json_write_integer(&params, follow->jobs[i].report.id);
            count++;
        }
    json_write_end_array(&params);
    json_write_end_object(&params);
    if (count > 0)
        ok = connection_call(connection, "job.list", params.text, &reply, error) && note_listed(follow, &reply, error);
    json_writer_finish(&params);
    return ok;
}

static void print_start(const struct follow *follow)
{
    if (!follow->params->prints_events) return;
    for (size_t i = 0; i < follow->count; i++)
        printf("{\"type\":\"job\",\"job\":%s}\n", follow->jobs[i].json);
    fflush(stdout);
}

static void draw(struct follow *follow, bool is_final)
{
    struct progress shown[SHOWN_LIMIT];
    size_t count = 0;

    if (!follow->params->shows_progress) return;
    for (size_t i = follow->count > SHOWN_LIMIT ? follow->count - SHOWN_LIMIT : 0; i < follow->count; i++)
        job_report_fill_progress(&follow->jobs[i].report, &shown[count++]);
    progress_display_draw(&follow->display, shown, count, progress_now_ms(), is_final);
}

static bool have_ended(const struct follow *follow)
{
    if (follow->params->id_count == 0) return false;
    for (size_t i = 0; i < follow->count; i++)
        if (!job_report_has_ended(&follow->jobs[i].report)) return false;
    return true;
}

static enum exit_status report_end(struct follow *follow)
{
    enum exit_status status = EXIT_STATUS_DONE;
    struct json_writer *jobs = follow->params->jobs;

    if (jobs) json_write_begin_object(jobs);
    if (jobs) json_write_key(jobs, "jobs");
    if (jobs) json_write_begin_array(jobs);
    for (size_t i = 0; i < follow->count; i++) {
        const struct job_report *report = &follow->jobs[i].report;

        if (job_report_status(report) != EXIT_STATUS_DONE) status = EXIT_STATUS_FAILED;
        if (jobs) json_write_raw(jobs, follow->jobs[i].json, strlen(follow->jobs[i].json));
        if (follow->params->ends) tell_state(follow->params->ends, report);
    }
    if (jobs) json_write_end_array(jobs);
    if (jobs) json_write_end_object(jobs);
    return status;
}

static enum exit_status follow_events(struct follow *follow, struct connection *connection, struct error *error)
{
    while (!have_ended(follow)) {
        struct message message;
        enum connection_event event = connection_next(connection, TICK_MS, &message, error);
        bool ok = true;

        if (event == CONNECTION_INTERRUPTED) {
            draw(follow, true);
            return EXIT_STATUS_INTERRUPTED;
        }
        if (event == CONNECTION_CLOSED) return connection_failure(connection);
        if (event == CONNECTION_MESSAGE) {
            ok = on_message(follow, &message, error);
            message_finish(&message);
        }
        if (!ok) return EXIT_STATUS_FAILED;
        if (!ask_why(follow, connection, error)) return connection_failure(connection);
        draw(follow, false);
    }
    draw(follow, true);
    return report_end(follow);
}

static enum exit_status follow_once(struct follow *follow, struct connection *connection, struct error *error)
{
    connection_set_interrupt(connection, &follow->interrupt);
    if (!subscribe(follow, connection, error) || !ask_jobs(follow, connection, error))
        return connection_failure(connection);
    follow->lost_ms = 0;
    print_start(follow);
    return follow_events(follow, connection, error);
}

// Waits until a daemon answers again: it was restarted, or is upgraded.
static enum exit_status reconnect(struct follow *follow, struct connection **connection, struct error *error)
{
    const struct options *options = follow->params->options;
    int64_t limit_s = options->reconnect_s >= 0 ? options->reconnect_s : RECONNECT_DEFAULT_S;
    enum exit_status status = EXIT_STATUS_NO_DAEMON;
    struct pollfd interrupted = {.fd = follow->interrupt.fd, .events = POLLIN};
    struct error silence = {0};

    if (limit_s == 0) return status;
    if (follow->lost_ms == 0) {
        progress_display_clear(&follow->display);
        fprintf(stderr, "%s: waiting up to %" PRId64 " s for it to come back\n", error->message, limit_s);
        follow->lost_ms = progress_now_ms();
    }
    connection_close(*connection);
    *connection = NULL;
    while (status == EXIT_STATUS_NO_DAEMON && progress_now_ms() < follow->lost_ms + 1000 * limit_s) {
        if (poll(&interrupted, 1, TICK_MS) > 0) return EXIT_STATUS_INTERRUPTED;
        *connection = daemon_call_connect(options, &status, &silence);
        if (*connection) {
            *error = (struct error){0};
            return EXIT_STATUS_DONE;
        }
    }
    *error = silence;
    return status;
}

enum exit_status follow_jobs(struct connection **connection, const struct follow_params *params, struct error *error)
{
    struct follow follow = {.params = params};
    enum exit_status status;

    progress_display_init(&follow.display, stderr);
    interrupt_init(&follow.interrupt);
    do {
        status = follow_once(&follow, *connection, error);
        if (status != EXIT_STATUS_NO_DAEMON) break;
        status = reconnect(&follow, connection, error);
    } while (status == EXIT_STATUS_DONE);
    if (*connection) connection_set_interrupt(*connection, NULL);
    interrupt_finish(&follow.interrupt);
    for (size_t i = 0; i < follow.count; i++) {
        job_report_finish(&follow.jobs[i].report);
        free(follow.jobs[i].json);
        free(follow.jobs[i].told);
    }
    free(follow.jobs);
    return status;
}
