// SPDX-License-Identifier: Apache-2.0
#include "daemon/workers/worker_process.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "core/wire/worker_status.h"
#include "daemon/workers/job_fence.h"
#include "daemon/workers/worker_environment.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    CHANNEL_FD = 3,
    LAST_WORDS_MS = 1000, // wait for output after its exit: a grandchild may hold its pipes open
    EXIT_MS = 5000,       // wait for its exit after it closed its channel
    READS_LIMIT = 16      // reads of waiting errors in a row, so that endless output does not hold the loop
};

struct worker_write {
    uv_write_t request;
    char bytes[];
};

static void on_allocate_channel(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer);
static void on_channel_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buffer);
static void on_allocate_errors(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer);
static void on_errors_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buffer);
static void on_written(uv_write_t *request, int status);
static void on_process_exit(uv_process_t *process, int64_t exit_status, int term_signal);
static void on_handle_closed(uv_handle_t *handle);

static void init_pipes(uv_loop_t *loop, struct worker_process *worker)
{
    uv_pipe_init(loop, &worker->channel, 0);
    uv_pipe_init(loop, &worker->errors, 0);
    worker->channel.data = worker->errors.data = worker->process.data = worker;
}

// The worker gets a session of its own: Ctrl-C in a terminal reaches the daemon only, which stops its workers in order.
static int spawn(uv_loop_t *loop, struct worker_process *worker, const struct worker_params *params, char **environment)
{
    char memory[24];
    // libuv takes them without const but does not change them.
    const char *arguments[16] = {params->program, "--fd", "3", "--backend", params->backend};
    size_t count = 5;
    uv_stdio_container_t stdio[] = {
        {.flags = UV_IGNORE},
        {.flags = UV_IGNORE}, // not the daemon's log, where its lines could pass for the daemon's
        {.flags = UV_CREATE_PIPE | UV_WRITABLE_PIPE, .data.stream = (uv_stream_t *)&worker->errors},
        {.flags = UV_CREATE_PIPE | UV_READABLE_PIPE | UV_WRITABLE_PIPE, .data.stream = (uv_stream_t *)&worker->channel},
    };
    uv_process_options_t options = {.exit_cb = on_process_exit,
                                    .file = params->program,
                                    .args = (char **)arguments,
                                    .env = environment,
                                    .flags = UV_PROCESS_DETACHED,
                                    .stdio_count = CHANNEL_FD + 1,
                                    .stdio = stdio};

    if (params->shader_folder) {
        arguments[count++] = "--shader-dir";
        arguments[count++] = params->shader_folder;
    }
    if (params->memory_bytes > 0) {
        snprintf(memory, sizeof memory, "%lld", (long long)params->memory_bytes);
        arguments[count++] = "--memory";
        arguments[count++] = memory;
    }
    if (!params->has_sandbox) {
        arguments[count++] = "--sandbox";
        arguments[count++] = "no";
    }
    if (params->job) arguments[count++] = "--fenced";
    return uv_spawn(loop, &worker->process, &options);
}

struct worker_process *worker_process_start(uv_loop_t *loop, const struct worker_params *params,
                                            const struct worker_handlers *handlers, struct error *error)
{
    struct worker_process *worker = xcalloc(1, sizeof *worker);
    char **environment = worker_environment_create(params->thread_count);
    int status;

    worker->id = params->id;
    worker->handlers = handlers;
    worker->job = params->job;
    worker->fence = params->fence;
    worker->memory_bytes = params->memory_bytes;
    worker->open_handles = 3;
    init_pipes(loop, worker);
    status = spawn(loop, worker, params, environment);
    worker_environment_destroy(environment);
    if (status != 0) {
        error_set(error, "%s: %s", params->program, uv_strerror(status));
        worker->is_gone = true;
        worker_process_close(worker);
        return NULL;
    }
    worker->liveness.limits.progress_ms = params->progress_limit_ms;
    liveness_start(&worker->liveness, (int64_t)uv_now(loop));
    uv_read_start((uv_stream_t *)&worker->channel, on_allocate_channel, on_channel_read);
    uv_read_start((uv_stream_t *)&worker->errors, on_allocate_errors, on_errors_read);
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
    return uv_process_get_pid(&worker->process);
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

static void on_allocate_channel(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer)
{
    struct worker_process *worker = handle->data;
    size_t room;
    char *bytes = message_stream_reserve(&worker->stream, &room);

    *buffer = uv_buf_init(bytes, (unsigned)(room < suggested ? room : suggested));
}

static void note_end(struct worker_process *worker)
{
    if (worker->ended_ms == 0) worker->ended_ms = (int64_t)uv_now(worker->process.loop);
    if (worker->is_gone || !worker->has_exited || !worker->has_channel_ended || !worker->has_errors_ended) return;
    worker->is_gone = true;
    worker->handlers->on_gone(worker->handlers->user, worker);
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

static void handle_lines(struct worker_process *worker)
{
    struct error error = {0};
    const char *line;
    size_t length;

    while (!worker->has_channel_ended && (line = message_stream_next(&worker->stream, &length, &error))) {
        if (!handle_line(worker, line, length, &error)) break;
    }
    if (!error.message[0]) return;
    error_prefix(&error, "it sent an invalid message");
    worker_process_kill(worker, error.message);
    uv_read_stop((uv_stream_t *)&worker->channel);
    worker->has_channel_ended = true;
    note_end(worker);
}

static void on_channel_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buffer)
{
    struct worker_process *worker = stream->data;

    if (count > 0) {
        message_stream_commit(&worker->stream, (size_t)count);
        handle_lines(worker);
    } else if (count < 0) {
        uv_read_stop(stream);
        worker->has_channel_ended = true;
        note_end(worker);
    }
}

static void on_allocate_errors(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer)
{
    struct worker_process *worker = handle->data;
    size_t kept = WORKER_LOG_BYTES / 2;

    if (worker->log_length > kept) {
        memmove(worker->log, worker->log + worker->log_length - kept, kept);
        worker->log_length = kept;
    }
    *buffer = uv_buf_init(worker->log + worker->log_length, (unsigned)(WORKER_LOG_BYTES - worker->log_length));
}

static void note_errors(struct worker_process *worker, size_t count)
{
    struct log_subject subject = worker_process_subject(worker);

    log_about(LOG_DEBUG, &subject, "worker %d says: %.*s", worker->id, (int)count, worker->log + worker->log_length);
    worker->log_length += count;
    worker->log[worker->log_length] = '\0';
}

static void on_errors_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buffer)
{
    struct worker_process *worker = stream->data;

    if (count > 0) {
        note_errors(worker, (size_t)count);
    } else if (count < 0) {
        uv_read_stop(stream);
        worker->has_errors_ended = true;
        note_end(worker);
    }
}

static void on_process_exit(uv_process_t *process, int64_t exit_status, int term_signal)
{
    struct worker_process *worker = process->data;

    worker->has_exited = true;
    worker->exit_status = exit_status;
    worker->exit_signal = term_signal;
    worker->ended_ms = 0;
    note_end(worker);
}

void worker_process_kill(struct worker_process *worker, const char *reason)
{
    if (!worker->end_reason) worker->end_reason = xasprintf("killed: %s", reason);
    worker->state = WORKER_STOPPING;
    if (!worker->has_exited) uv_process_kill(&worker->process, SIGKILL);
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

void worker_process_check(struct worker_process *worker, int64_t now_ms)
{
    bool is_overdue =
        worker->ended_ms != 0 && now_ms - worker->ended_ms > (worker->has_exited ? LAST_WORDS_MS : EXIT_MS);

    if (worker->has_exited && is_overdue) {
        worker->has_channel_ended = worker->has_errors_ended = true;
        note_end(worker);
    } else if (is_overdue) {
        worker_process_kill(worker, "it closed its channel and did not exit");
    } else if (worker->stop_by_ms != 0 && now_ms >= worker->stop_by_ms) {
        worker_process_kill(worker, "it did not stop in time");
    }
}

void worker_process_send(struct worker_process *worker, const struct json_writer *messages)
{
    struct worker_write *write;
    uv_buf_t buffer;

    if (worker->has_channel_ended) return;
    write = xmalloc(sizeof *write + messages->length);
    memcpy(write->bytes, messages->text, messages->length);
    buffer = uv_buf_init(write->bytes, (unsigned)messages->length);
    if (uv_write(&write->request, (uv_stream_t *)&worker->channel, &buffer, 1, on_written) != 0) free(write);
}

// A write fails only when the worker is dying; the end of its channel reports that.
static void on_written(uv_write_t *request, int status)
{
    free((struct worker_write *)request);
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

// Reads waiting errors: text from before a message may arrive after it, on another pipe.
static void read_waiting_errors(struct worker_process *worker)
{
    uv_os_fd_t pipe;
    ssize_t count = 1;

    if (worker->has_errors_ended || uv_fileno((const uv_handle_t *)&worker->errors, &pipe) != 0) return;
    for (int i = 0; i < READS_LIMIT && count > 0; i++) {
        uv_buf_t buffer;

        on_allocate_errors((uv_handle_t *)&worker->errors, 0, &buffer);
        count = read(pipe, buffer.base, buffer.len); // it does not block; the loop sees its end
        if (count > 0) note_errors(worker, (size_t)count);
    }
}

void worker_process_forget_log(struct worker_process *worker)
{
    read_waiting_errors(worker);
    worker->log_length = 0;
    worker->log[0] = '\0';
}

char *worker_process_take_log(struct worker_process *worker, const char *reason)
{
    char *log;

    read_waiting_errors(worker);
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
    uv_close((uv_handle_t *)&worker->channel, on_handle_closed);
    uv_close((uv_handle_t *)&worker->errors, on_handle_closed);
    uv_close((uv_handle_t *)&worker->process, on_handle_closed);
}

static void on_handle_closed(uv_handle_t *handle)
{
    struct worker_process *worker = handle->data;

    if (--worker->open_handles > 0) return;
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
    message_stream_finish(&worker->stream);
    free(worker);
}
