// SPDX-License-Identifier: Apache-2.0
#include "daemon/workers/worker_process.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "core/wire/worker_status.h"
#include "daemon/nodes/node.h"
#include "daemon/settings/pool_options.h"
#include "daemon/workers/job_fence.h"

#include <stdlib.h>
#include <string.h>

static bool on_line(void *user, const char *line, size_t length);
static void on_overlong(void *user, const struct error *error);
static void on_log(void *user, const char *bytes, size_t count);
static void on_end(void *user, int64_t status, int signal, const char *reason);

static const struct worker_child_handlers link_handlers = {
    .on_line = on_line, .on_overlong = on_overlong, .on_log = on_log, .on_end = on_end};

static void free_process(struct worker_process *worker)
{
    free(worker->backend);
    free(worker->vendor);
    free(worker->renderer);
    free(worker->version);
    free(worker->device_uuid);
    free(worker->sandbox);
    free(worker->end_reason);
    free(worker->known_jobs);
    job_fence_destroy(worker->fence);
    in_flight_finish(&worker->in_flight);
    free(worker);
}

struct worker_process *worker_process_start(uv_loop_t *loop, const struct worker_params *params,
                                            const struct worker_handlers *handlers, struct error *error)
{
    struct worker_process *worker = xcalloc(1, sizeof *worker);

    worker->id = params->id;
    worker->handlers = handlers;
    worker->job = params->job;
    worker->fence = params->fence;
    worker->memory_bytes = params->child.memory_bytes;
    worker->node = params->node;
    worker->heartbeat_ms = params->node ? node_pool(params->node)->heartbeat_ms : 0;
    if (params->node) {
        node_start_worker(params->node, params->id, &worker->link, &params->child, &link_handlers, worker);
    } else if (!worker_link_start_here(&worker->link, loop, &params->child, &link_handlers, worker, error)) {
        free_process(worker);
        return NULL;
    }
    worker->liveness.limits.progress_ms = params->progress_limit_ms;
    liveness_start(&worker->liveness, (int64_t)uv_now(loop));
    if (params->job) worker_process_send(worker, params->first);
    return worker;
}

struct log_subject worker_process_subject(const struct worker_process *worker)
{
    const struct in_flight_frame *frame = in_flight_current(&worker->in_flight);

    if (!frame) return (struct log_subject){.worker = worker->id};
    return (struct log_subject){.job = frame->ticket.job,
                                .frame = frame->ticket.frame,
                                .attempt = frame->is_started ? frame->ticket.attempt : 0,
                                .worker = worker->id};
}

int worker_process_pid(const struct worker_process *worker)
{
    return worker->link.calls->pid(worker->link.self);
}

const char *worker_process_node(const struct worker_process *worker)
{
    return worker->node ? node_name(worker->node) : NULL;
}

static char *copy_text(const char *text)
{
    return text ? xstrdup(text) : NULL;
}

void worker_process_note_ready(struct worker_process *worker, const struct worker_report *report)
{
    worker->state = WORKER_READY;
    worker->backend = xstrdup(report->backend);
    worker->vendor = xstrdup(report->vendor);
    worker->renderer = xstrdup(report->renderer);
    worker->version = xstrdup(report->version);
    worker->device_uuid = copy_text(report->device_uuid);
    worker->sandbox = copy_text(report->sandbox);
}

void worker_process_note_clocks(struct worker_process *worker, const struct worker_report *report, int64_t now_ms)
{
    switch (report->kind) {
    case WORKER_REPORT_BEAT:
        liveness_progress(&worker->liveness, report->progress, now_ms);
        break;
    case WORKER_REPORT_STARTED:
        liveness_begin_frame(&worker->liveness, now_ms);
        break;
    case WORKER_REPORT_PLANNING: // planning is for many frames: the time of one frame does not limit it
        liveness_begin_plan(&worker->liveness, now_ms);
        break;
    case WORKER_REPORT_PLANNED:
        liveness_end_plan(&worker->liveness, now_ms);
        break;
    case WORKER_REPORT_RENDERED:
    case WORKER_REPORT_SKIPPED:
    case WORKER_REPORT_FAILED:
        liveness_end_frame(&worker->liveness, now_ms);
        break;
    default:
        liveness_note_message(&worker->liveness, now_ms);
        break;
    }
}

bool worker_process_is_host(const struct worker_process *worker, int64_t job)
{
    return worker->fence && worker->job != job;
}

static bool handle_line(struct worker_process *worker, const char *line, size_t length, struct error *error)
{
    struct message message = {0};
    struct worker_report report;
    enum message_code code;
    bool ok = message_decode(&message, line, length, &code, error) && worker_report_read(&report, &message, error);

    if (ok) worker->handlers->on_report(worker->handlers->user, worker, &report);
    message_finish(&message);
    return ok;
}

static bool on_line(void *user, const char *line, size_t length)
{
    struct worker_process *worker = user;
    struct error error = {0};

    if (handle_line(worker, line, length, &error)) return true;
    on_overlong(worker, &error);
    return false;
}

static void on_overlong(void *user, const struct error *error)
{
    struct worker_process *worker = user;
    struct error reason = *error;

    error_prefix(&reason, "it sent an invalid message");
    worker_process_kill(worker, reason.message);
}

// Keeps the end of the log.
static void on_log(void *user, const char *bytes, size_t count)
{
    struct worker_process *worker = user;
    struct log_subject subject = worker_process_subject(worker);
    size_t kept = WORKER_LOG_BYTES / 2;

    log_about(LOG_DEBUG, &subject, "worker %d says: %.*s", worker->id, (int)count, bytes);
    if (worker->log_length + count > WORKER_LOG_BYTES && worker->log_length > kept) {
        memmove(worker->log, worker->log + worker->log_length - kept, kept);
        worker->log_length = kept;
    }
    memcpy(worker->log + worker->log_length, bytes, count);
    worker->log_length += count;
    worker->log[worker->log_length] = '\0';
}

static void on_end(void *user, int64_t status, int signal, const char *reason)
{
    struct worker_process *worker = user;

    worker->is_over = true;
    worker->is_node_lost = reason != NULL;
    if (reason && !worker->end_reason) worker->end_reason = xstrdup(reason);
    worker->exit_status = status;
    worker->exit_signal = signal;
    worker->handlers->on_gone(worker->handlers->user, worker);
}

void worker_process_kill(struct worker_process *worker, const char *reason)
{
    if (!worker->end_reason) worker->end_reason = xasprintf("killed: %s", reason);
    worker->state = WORKER_STOPPING;
    if (!worker->is_over) worker->link.calls->kill(worker->link.self);
}

void worker_process_expect_exit(struct worker_process *worker, int64_t stop_by_ms)
{
    worker->stop_by_ms = stop_by_ms;
    worker->state = WORKER_STOPPING;
}

void worker_process_exit(struct worker_process *worker, int64_t stop_by_ms)
{
    struct json_writer writer = {0};

    worker_process_expect_exit(worker, stop_by_ms);
    message_begin_notification(&writer, "worker.exit");
    json_write_begin_object(&writer);
    json_write_end_object(&writer);
    message_end(&writer);
    worker_process_send(worker, &writer);
    json_writer_finish(&writer);
}

void worker_process_doubt_node(struct worker_process *worker, int64_t stop_by_ms)
{
    if (!worker->node) return;
    node_look_at_roots(worker->node);
    worker_process_exit(worker, stop_by_ms);
}

void worker_process_check(struct worker_process *worker, int64_t now_ms)
{
    const char *fault;

    if (worker->stop_by_ms != 0 && now_ms >= worker->stop_by_ms) worker_process_kill(worker, "it did not stop in time");
    // It may be gone after this.
    fault = worker->link.calls->check(worker->link.self);
    if (fault) worker_process_kill(worker, fault);
}

void worker_process_send(struct worker_process *worker, const struct json_writer *messages)
{
    if (!worker->is_over) worker->link.calls->send(worker->link.self, messages->text, messages->length);
}

char *worker_process_describe_end(const struct worker_process *worker)
{
    if (worker->end_reason) return xstrdup(worker->end_reason);
    if (worker->exit_signal)
        return xasprintf("killed by signal %d (%s)", worker->exit_signal, strsignal(worker->exit_signal));
    if (worker->exit_status == WORKER_STATUS_MEMORY && worker->memory_bytes > 0)
        return xasprintf("out of memory: a worker may have %.3g GiB (worker-memory)",
                         (double)worker->memory_bytes / (1 << 30));
    return xasprintf("exit status %lld", (long long)worker->exit_status);
}

void worker_process_forget_log(struct worker_process *worker)
{
    worker->link.calls->read_log(worker->link.self);
    worker->log_length = 0;
    worker->log[0] = '\0';
}

char *worker_process_take_log(struct worker_process *worker, const char *reason)
{
    char *log;

    worker->link.calls->read_log(worker->link.self);
    log = xasprintf("%s%s%s", reason ? reason : "", reason && worker->log_length ? "\n" : "", worker->log);
    worker->log_length = 0;
    worker->log[0] = '\0';
    return log;
}

bool worker_process_knows_job(const struct worker_process *worker, int64_t job)
{
    for (size_t i = 0; i < worker->known_count; i++) {
        if (worker->known_jobs[i] == job) return true;
    }
    return false;
}

void worker_process_learn_job(struct worker_process *worker, int64_t job)
{
    worker->known_jobs =
        xgrow(worker->known_jobs, &worker->known_capacity, worker->known_count + 1, sizeof worker->known_jobs[0]);
    worker->known_jobs[worker->known_count++] = job;
}

static void begin_about_job(struct json_writer *writer, const char *method, int64_t job)
{
    message_begin_notification(writer, method);
    json_write_begin_object(writer);
    json_write_integer_member(writer, "job", job);
}

static void send_about_job(struct worker_process *worker, struct json_writer *writer)
{
    json_write_end_object(writer);
    message_end(writer);
    worker_process_send(worker, writer);
    json_writer_finish(writer);
}

void worker_process_forget_job(struct worker_process *worker, int64_t job)
{
    struct json_writer writer = {0};

    for (size_t i = 0; i < worker->known_count; i++) {
        if (worker->known_jobs[i] == job) worker->known_jobs[i--] = worker->known_jobs[--worker->known_count];
    }
    begin_about_job(&writer, "worker.forget", job);
    send_about_job(worker, &writer);
}

void worker_process_drop_job(struct worker_process *worker, int64_t job, bool running)
{
    struct json_writer writer = {0};

    begin_about_job(&writer, "worker.drop", job);
    json_write_bool_member(&writer, "running", running);
    send_about_job(worker, &writer);
}

void worker_process_close(struct worker_process *worker)
{
    worker->link.calls->close(worker->link.self);
    free_process(worker);
}
