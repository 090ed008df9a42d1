// SPDX-License-Identifier: Apache-2.0
#include "cli/render/render_session.h"

#include "cli/peer/connection.h"
#include "cli/peer/worker_child.h"
#include "cli/program/interrupt.h"
#include "cli/program/options.h"
#include "cli/render/render_plan.h"
#include "cli/terminal/progress.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/json/json_write.h"
#include "core/wire/publish.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <pwd.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { TICK_MS = 200, JOB_ID = 0, PROGRESS_LIMIT_S = 120 };

enum step { STEP_ON, STEP_STOP, STEP_WORKER_LOST };

struct session {
    const struct render_session_params *params; // borrowed
    struct render_plan plan;
    struct worker_child child;
    int folder_fd; // where the files go
    int64_t epoch;
    int64_t failed, missed;
    bool is_ready;
    double progress;    // from the worker's heartbeats
    int64_t moved_ms;   // when `progress` last grew
    bool is_stuck;      // it has not grown for too long
    struct error fault; // the worker's own reason for its end, or why it was ended
};

static void report(struct session *session, struct render_result *result)
{
    char name[OUTPUT_NAME_SIZE];
    const char *folder = session->params->job->output.path.folder;
    char *path;

    output_path_format_name(&session->params->job->output.path, result->frame, name);
    path = *folder ? xasprintf("%s/%s", folder, name) : xstrdup(name);
    result->name = path;
    if (result->outcome == RENDER_FAILED) session->failed++;
    if (result->accuracy.is_missed) session->missed++;
    session->params->on_result(session->params->user, result);
    free(path);
}

static void report_failed(struct session *session, int32_t frame, const char *why)
{
    struct render_result result = {.frame = frame, .outcome = RENDER_FAILED, .error = why};

    report(session, &result);
}

static void format_part(const struct session *session, const struct render_ticket *ticket,
                        char name[static OUTPUT_NAME_SIZE])
{
    const struct output_part part = {
        .job = JOB_ID, .epoch = session->epoch, .frame = ticket->frame, .attempt = ticket->attempt};

    output_path_format_part(&session->params->job->output.path, &part, name);
}

static void remove_part(struct session *session, const struct render_ticket *ticket)
{
    char part[OUTPUT_NAME_SIZE];

    format_part(session, ticket, part);
    unlinkat(session->folder_fd, part, 0);
}

static void remove_parts(struct session *session)
{
    for (size_t i = 0; i < session->plan.in_flight_count; i++)
        remove_part(session, &session->plan.in_flight[i]);
}

// Failures to send are ignored: that a worker is gone shows when its messages are read, which include its last words.
static void send_job(struct session *session)
{
    const struct passwd *user = getpwuid(getuid());
    struct json_writer line = {0};

    message_begin_notification(&line, "worker.job");
    json_write_begin_object(&line);
    json_write_integer_member(&line, "job", JOB_ID);
    json_write_integer_member(&line, "epoch", session->epoch);
    json_write_string_member(&line, "root", session->params->root);
    json_write_string_member(&line, "owner", user ? user->pw_name : "");
    if (session->params->plan_of) json_write_string_member(&line, "plan_of", session->params->plan_of);
    if (session->params->preview) json_write_string_member(&line, "preview", session->params->preview);
    json_write_key(&line, "document");
    json_write_raw(&line, session->params->document, strlen(session->params->document));
    json_write_end_object(&line);
    message_end(&line);
    connection_send(session->child.connection, &line, NULL);
    json_writer_finish(&line);
}

static void assign(struct session *session)
{
    struct json_writer line = {0};
    struct render_ticket ticket;
    size_t count = 0;

    message_begin_notification(&line, "worker.assign");
    json_write_begin_object(&line);
    json_write_integer_member(&line, "job", JOB_ID);
    json_write_key(&line, "frames");
    json_write_begin_array(&line);
    for (; render_plan_take(&session->plan, &ticket); count++) {
        json_write_begin_array(&line);
        json_write_integer(&line, ticket.frame);
        json_write_integer(&line, ticket.attempt);
        json_write_end_array(&line);
    }
    json_write_end_array(&line);
    json_write_end_object(&line);
    message_end(&line);
    if (count > 0) connection_send(session->child.connection, &line, NULL);
    json_writer_finish(&line);
}

static bool start_worker(struct session *session, struct error *error)
{
    session->is_ready = session->is_stuck = false;
    session->fault.message[0] = 0;
    if (!worker_child_start(&session->child, session->params->options, session->params->interrupt, error)) return false;
    send_job(session);
    assign(session);
    return true;
}

static bool read_ticket(const struct json_node *body, struct render_ticket *ticket, struct error *error)
{
    struct json_node frame = json_node_child(body, "frame"), attempt = json_node_child(body, "attempt");
    int64_t frame_number, attempt_number;

    if (!json_read_integer(&frame, 0, FRAME_NUMBER_LIMIT - 1, &frame_number, error)) return false;
    if (!json_read_integer(&attempt, 1, INT32_MAX, &attempt_number, error)) return false;
    *ticket = (struct render_ticket){.frame = (int32_t)frame_number, .attempt = (int)attempt_number};
    return true;
}

static bool read_file(const struct json_node *body, struct published_file *file, struct render_result *result,
                      struct error *error)
{
    struct json_node inode = json_node_child(body, "inode"), size = json_node_child(body, "size_bytes");
    struct json_node hash = json_node_child(body, "hash");
    struct json_node render_s = json_node_child(body, "render_s"), encode_s = json_node_child(body, "encode_s");
    const char *digits;

    if (!json_read_string(&inode, &digits, error)) return false;
    if (!json_read_integer(&size, 0, INT64_C(1) << 53, &result->size_bytes, error)) return false;
    if (!json_read_string(&hash, &result->hash, error)) return false;
    if (!json_read_number(&render_s, 0, HUGE_VAL, &result->render_s, error)) return false;
    if (!json_read_number(&encode_s, 0, HUGE_VAL, &result->encode_s, error)) return false;
    if (!frame_accuracy_read(&result->accuracy, body, error)) return false;
    file->inode = strtoull(digits, NULL, 10);
    file->size_bytes = (uint64_t)result->size_bytes;
    memccpy(file->hash, result->hash, 0, sizeof file->hash - 1);
    return true;
}

static void on_finished(struct session *session, const struct render_ticket *ticket, const struct json_node *body)
{
    struct render_result result = {.frame = ticket->frame, .outcome = RENDER_SUCCEEDED};
    struct published_file file = {0};
    struct error error = {0};
    char part[OUTPUT_NAME_SIZE], name[OUTPUT_NAME_SIZE];

    format_part(session, ticket, part);
    output_path_format_name(&session->params->job->output.path, ticket->frame, name);
    if (!read_file(body, &file, &result, &error) || !publish_file(session->folder_fd, part, name, &file, &error) ||
        !publish_sync(session->folder_fd, &error)) {
        unlinkat(session->folder_fd, part, 0);
        report_failed(session, ticket->frame, error.message);
        return;
    }
    report(session, &result);
}

static void on_skipped(struct session *session, const struct render_ticket *ticket, const struct json_node *body)
{
    struct render_result result = {.frame = ticket->frame, .outcome = RENDER_SKIPPED};
    struct json_node size = json_node_child(body, "size_bytes"), hash = json_node_child(body, "hash");

    json_read_integer(&size, 0, INT64_C(1) << 53, &result.size_bytes, NULL);
    json_read_string(&hash, &result.hash, NULL);
    frame_accuracy_read(&result.accuracy, body, NULL);
    report(session, &result);
}

// A fault of the job or of the output concerns all frames: the others are not tried.
static enum step on_failed(struct session *session, const struct render_ticket *ticket, const struct json_node *body,
                           struct error *error)
{
    static const char *const faults[] = {"job", "frame", "worker", "output", "endless", "cut", "missed", NULL};
    struct json_node fault = json_node_child(body, "fault"), text = json_node_child(body, "error");
    const char *why = "failed without saying why";
    int choice = 1;

    json_read_enum(&fault, faults, &choice, NULL);
    json_read_string(&text, &why, NULL);
    remove_part(session, ticket);
    report_failed(session, ticket->frame, why);
    if (choice != 0 && choice != 3) return STEP_ON;
    error_set(error, "%s", why);
    return STEP_STOP;
}

static const char *text_of(const struct json_node *body, const char *key)
{
    struct json_node node = json_node_child(body, key);
    const char *text = "?";

    json_read_string(&node, &text, NULL);
    return text;
}

// What a running frame is at. False: the event is another one.
static bool note_phase(const struct session *session, const char *event, const struct json_node *body)
{
    const struct render_session_params *params = session->params;
    struct json_node node = json_node_child(body, "frames"), progress_node = json_node_child(body, "progress");
    struct json_node seconds = json_node_child(body, "render_s");
    int64_t frame_count = 0;
    double progress = -1.0, render_s = 0.0;

    if (strcmp(event, "planning") == 0) {
        params->on_phase(params->user, "plan", 0.0);
    } else if (strcmp(event, "planned") == 0) {
        json_read_integer(&node, 0, FRAME_COUNT_LIMIT, &frame_count, NULL);
        json_read_number(&seconds, 0.0, HUGE_VAL, &render_s, NULL);
        params->on_planned(params->user, frame_count, render_s);
    } else if (strcmp(event, "phase") == 0) {
        json_read_number(&progress_node, 0.0, 1.0, &progress, NULL);
        params->on_phase(params->user, text_of(body, "phase"), progress);
    } else {
        return false;
    }
    return true;
}

static enum step on_frame(struct session *session, const struct message *message, struct error *error)
{
    const char *event = message->method + strlen("frame.");
    enum step step = STEP_ON;
    struct render_ticket ticket;

    if (!read_ticket(&message->body, &ticket, error)) return STEP_STOP;
    if (strcmp(event, "started") == 0) {
        render_plan_start(&session->plan, ticket.frame);
        return STEP_ON;
    }
    if (note_phase(session, event, &message->body)) return STEP_ON;
    if (strcmp(event, "rendered") == 0) {
        render_plan_render(&session->plan, ticket.frame);
        return STEP_ON;
    }
    // A worker that lost its context ends after this message; the next worker tries the frame again.
    if (strcmp(event, "failed") == 0 && strcmp(text_of(&message->body, "fault"), "worker") == 0) {
        error_set(&session->fault, "%s", text_of(&message->body, "error"));
        return STEP_ON;
    }
    if (!render_plan_end(&session->plan, ticket.frame, ticket.attempt)) return STEP_ON;
    if (strcmp(event, "finished") == 0)
        on_finished(session, &ticket, &message->body);
    else if (strcmp(event, "skipped") == 0)
        on_skipped(session, &ticket, &message->body);
    else if (strcmp(event, "failed") == 0)
        step = on_failed(session, &ticket, &message->body, error);
    else if (strcmp(event, "dropped") == 0)
        report_failed(session, ticket.frame, "the worker gave it back");
    if (step == STEP_ON) assign(session);
    return step;
}

// Heartbeats and phases are told even if a frame makes no progress.
static void note_progress(struct session *session, const struct message *message)
{
    struct json_node node = json_node_child(&message->body, "progress");
    double progress = session->progress;

    if (strcmp(message->method, "frame.phase") == 0) return;
    if (strcmp(message->method, "worker.beat") == 0 && json_read_number(&node, 0, HUGE_VAL, &progress, NULL) &&
        progress == session->progress)
        return;
    session->progress = progress;
    session->moved_ms = progress_now_ms();
}

// True when a worker with frames in flight makes no progress and must be ended.
static bool is_stuck(struct session *session)
{
    const struct options *options = session->params->options;
    const char *code = scene_find_code(&session->params->job->scene);
    int64_t limit_s = options->progress_limit_s > 0 ? options->progress_limit_s : PROGRESS_LIMIT_S;

    if (!session->is_ready || session->plan.in_flight_count == 0) return false;
    if (progress_now_ms() - session->moved_ms <= 1000 * limit_s) return false;
    error_set(&session->fault, "no progress for %lld s%s%s%s", (long long)limit_s, code ? ": does density in " : "",
              code ? code : "", code ? " end?" : "");
    session->is_stuck = true;
    return true;
}

static enum step on_message(struct session *session, const struct message *message, struct error *error)
{
    if (message->kind != MESSAGE_NOTIFICATION) return STEP_ON;
    note_progress(session, message);
    if (strcmp(message->method, "worker.failed") == 0) {
        error_set(error, "march-worker: %s", text_of(&message->body, "error"));
        return STEP_STOP;
    }
    if (strcmp(message->method, "worker.ready") == 0) {
        session->is_ready = true;
        session->params->on_worker(session->params->user, text_of(&message->body, "backend"),
                                   text_of(&message->body, "renderer"));
        return STEP_ON;
    }
    if (strncmp(message->method, "frame.", strlen("frame.")) == 0) return on_frame(session, message, error);
    return STEP_ON;
}

// Hands the frames of a worker that is gone to a new one. False when that is pointless.
static bool replace_worker(struct session *session, struct error *error)
{
    struct render_ticket given_up[RENDER_PLAN_AHEAD];
    size_t count;
    bool was_ready = session->is_ready, is_endless;

    if (!session->is_stuck) worker_child_explain_end(&session->child, error);
    if (session->fault.message[0]) *error = session->fault;
    worker_child_stop(&session->child, true);
    remove_parts(session);
    // The job's own code that did not end would not end in a second attempt either.
    is_endless = session->is_stuck && scene_find_code(&session->params->job->scene);
    count = render_plan_lose(&session->plan, is_endless, given_up);
    for (size_t i = 0; i < count; i++)
        report_failed(session, given_up[i].frame, error->message);
    if (!was_ready) return false;
    if (render_plan_is_done(&session->plan)) {
        error->message[0] = 0;
        return true;
    }
    session->params->on_worker_lost(session->params->user, error->message);
    error->message[0] = 0;
    return start_worker(session, error);
}

static enum exit_status run_frames(struct session *session, struct error *error)
{
    if (!start_worker(session, error)) return EXIT_STATUS_FAILED;
    while (!render_plan_is_done(&session->plan)) {
        struct message message;
        enum connection_event event = connection_next(session->child.connection, TICK_MS, &message, error);
        enum step step = event == CONNECTION_CLOSED ? STEP_WORKER_LOST : STEP_ON;

        if (event == CONNECTION_INTERRUPTED) return EXIT_STATUS_INTERRUPTED;
        if (event == CONNECTION_MESSAGE) {
            step = on_message(session, &message, error);
            message_finish(&message);
        }
        if (step == STEP_ON && is_stuck(session)) step = STEP_WORKER_LOST;
        if (step == STEP_STOP) return EXIT_STATUS_FAILED;
        if (step == STEP_WORKER_LOST && !replace_worker(session, error)) return EXIT_STATUS_FAILED;
        session->params->on_tick(session->params->user);
    }
    return session->failed + session->missed > 0 ? EXIT_STATUS_FAILED : EXIT_STATUS_DONE;
}

enum exit_status render_session_run(const struct render_session_params *params, struct error *error)
{
    struct session session = {
        .params = params, .epoch = getpid(), .plan = {.frames = &params->job->frames, .order = params->job->order}};
    struct error local = {0};
    enum exit_status status;

    session.folder_fd = output_path_open_folder(&params->job->output.path, params->root, true, error);
    if (session.folder_fd < 0) return EXIT_STATUS_FAILED;
    status = run_frames(&session, &local);
    if (local.message[0]) error_set(error, "%s", local.message);
    worker_child_stop(&session.child, status == EXIT_STATUS_INTERRUPTED || local.message[0]);
    remove_parts(&session);
    close(session.folder_fd);
    return status;
}
