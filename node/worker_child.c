// SPDX-License-Identifier: Apache-2.0
#include "node/worker_child.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/wire/message_stream.h"
#include "node/worker_environment.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    CHANNEL_FD = 3,
    LAST_WORDS_MS = 1000, // wait for output after its exit: a grandchild may hold its pipes open
    EXIT_MS = 5000,       // wait for its exit after it closed its channel
    READS_LIMIT = 16      // reads of a waiting log in a row, so that endless output does not hold the loop
};

struct worker_child {
    const struct worker_child_handlers *handlers; // borrowed; outlive us
    void *user;
    uv_process_t process;
    uv_pipe_t channel, errors;
    int open_handles;
    struct message_stream stream; // owned
    char log[WORKER_CHILD_LOG_BYTES];
    bool has_exited, has_channel_ended, has_errors_ended, is_over;
    int64_t exit_status;
    int exit_signal;
    uint64_t ended_ms; // time of its exit or of the end of its channel; 0: neither
};

struct child_write {
    uv_write_t request;
    char bytes[];
};

static void on_allocate_channel(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer);
static void on_channel_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buffer);
static void on_allocate_errors(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer);
static void on_errors_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buffer);
static void on_written(uv_write_t *request, int status);
static void on_exit_seen(uv_process_t *process, int64_t exit_status, int term_signal);
static void on_handle_closed(uv_handle_t *handle);

// The worker gets a session of its own: Ctrl-C in a terminal reaches this program only, which stops its workers in
// order.
static int spawn(uv_loop_t *loop, struct worker_child *child, const struct worker_child_params *params,
                 char **environment)
{
    char memory[24];
    // libuv takes them without const but does not change them.
    const char *arguments[16] = {params->program, "--fd", "3", "--backend", params->backend};
    size_t count = 5;
    uv_stdio_container_t stdio[] = {
        {.flags = UV_IGNORE},
        {.flags = UV_IGNORE}, // not our log, where its lines could pass for ours
        {.flags = UV_CREATE_PIPE | UV_WRITABLE_PIPE, .data.stream = (uv_stream_t *)&child->errors},
        {.flags = UV_CREATE_PIPE | UV_READABLE_PIPE | UV_WRITABLE_PIPE, .data.stream = (uv_stream_t *)&child->channel},
    };
    uv_process_options_t options = {.exit_cb = on_exit_seen,
                                    .file = params->program,
                                    .args = (char **)arguments,
                                    .env = environment,
                                    .flags = UV_PROCESS_DETACHED,
                                    .stdio_count = CHANNEL_FD + 1,
                                    .stdio = stdio};

    if (params->device) {
        arguments[count++] = "--device";
        arguments[count++] = params->device;
    }
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
    if (params->is_fenced) arguments[count++] = "--fenced";
    return uv_spawn(loop, &child->process, &options);
}

struct worker_child *worker_child_start(uv_loop_t *loop, const struct worker_child_params *params,
                                        const struct worker_child_handlers *handlers, void *user, struct error *error)
{
    struct worker_child *child = xcalloc(1, sizeof *child);
    char **environment = worker_environment_create(params->thread_count);
    int status;

    child->handlers = handlers;
    child->user = user;
    child->stream.limit_bytes = WORKER_CHILD_LINE_LIMIT;
    child->open_handles = 3;
    uv_pipe_init(loop, &child->channel, 0);
    uv_pipe_init(loop, &child->errors, 0);
    child->channel.data = child->errors.data = child->process.data = child;
    status = spawn(loop, child, params, environment);
    worker_environment_destroy(environment);
    if (status != 0) {
        error_set(error, "%s: %s", params->program, uv_strerror(status));
        worker_child_close(child);
        return NULL;
    }
    uv_read_start((uv_stream_t *)&child->channel, on_allocate_channel, on_channel_read);
    uv_read_start((uv_stream_t *)&child->errors, on_allocate_errors, on_errors_read);
    return child;
}

int worker_child_pid(const struct worker_child *child)
{
    return uv_process_get_pid(&child->process);
}

static void note_end(struct worker_child *child)
{
    if (child->ended_ms == 0) child->ended_ms = uv_now(child->process.loop);
    if (child->is_over || !child->has_exited || !child->has_channel_ended || !child->has_errors_ended) return;
    child->is_over = true;
    child->handlers->on_end(child->user, child->exit_status, child->exit_signal, NULL);
}

static void end_channel(struct worker_child *child)
{
    uv_read_stop((uv_stream_t *)&child->channel);
    child->has_channel_ended = true;
    note_end(child);
}

static void on_allocate_channel(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer)
{
    struct worker_child *child = handle->data;
    size_t room;
    char *bytes = message_stream_reserve(&child->stream, &room);

    *buffer = uv_buf_init(bytes, (unsigned)(room < suggested ? room : suggested));
}

static void hand_on_lines(struct worker_child *child)
{
    struct error error = {0};
    const char *line;
    size_t length;
    bool is_wanted = true;

    while (is_wanted && (line = message_stream_next(&child->stream, &length, &error)))
        is_wanted = child->handlers->on_line(child->user, line, length);
    if (error.message[0]) child->handlers->on_overlong(child->user, &error);
    if (error.message[0] || !is_wanted) end_channel(child);
}

static void on_channel_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buffer)
{
    struct worker_child *child = stream->data;

    if (count > 0) {
        message_stream_commit(&child->stream, (size_t)count);
        hand_on_lines(child);
    } else if (count < 0) {
        end_channel(child);
    }
}

static void on_allocate_errors(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer)
{
    struct worker_child *child = handle->data;

    *buffer = uv_buf_init(child->log, sizeof child->log);
}

static void on_errors_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buffer)
{
    struct worker_child *child = stream->data;

    if (count > 0) {
        child->handlers->on_log(child->user, buffer->base, (size_t)count);
    } else if (count < 0) {
        uv_read_stop(stream);
        child->has_errors_ended = true;
        note_end(child);
    }
}

void worker_child_read_log(struct worker_child *child)
{
    uv_os_fd_t pipe;
    ssize_t count = 1;

    if (child->has_errors_ended || uv_fileno((const uv_handle_t *)&child->errors, &pipe) != 0) return;
    for (int i = 0; i < READS_LIMIT && count > 0; i++) {
        count = read(pipe, child->log, sizeof child->log); // it does not block; the loop sees its end
        if (count > 0) child->handlers->on_log(child->user, child->log, (size_t)count);
    }
}

static void on_exit_seen(uv_process_t *process, int64_t exit_status, int term_signal)
{
    struct worker_child *child = process->data;

    child->has_exited = true;
    child->exit_status = exit_status;
    child->exit_signal = term_signal;
    child->ended_ms = 0;
    note_end(child);
}

void worker_child_kill(struct worker_child *child)
{
    if (!child->has_exited) uv_process_kill(&child->process, SIGKILL);
}

const char *worker_child_check(struct worker_child *child)
{
    uint64_t limit_ms = child->has_exited ? LAST_WORDS_MS : EXIT_MS;

    if (child->ended_ms == 0 || uv_now(child->process.loop) - child->ended_ms <= limit_ms) return NULL;
    if (!child->has_exited) return "it closed its channel and did not exit";
    child->has_channel_ended = child->has_errors_ended = true;
    note_end(child);
    return NULL;
}

void worker_child_send(struct worker_child *child, const char *bytes, size_t count)
{
    struct child_write *write;
    uv_buf_t buffer;

    if (child->has_channel_ended) return;
    write = xmalloc(sizeof *write + count);
    memcpy(write->bytes, bytes, count);
    buffer = uv_buf_init(write->bytes, (unsigned)count);
    if (uv_write(&write->request, (uv_stream_t *)&child->channel, &buffer, 1, on_written) != 0) free(write);
}

// A write fails only when the worker is dying; the end of its channel reports that.
static void on_written(uv_write_t *request, int status)
{
    free((struct child_write *)request);
}

void worker_child_close(struct worker_child *child)
{
    child->is_over = true;
    uv_close((uv_handle_t *)&child->channel, on_handle_closed);
    uv_close((uv_handle_t *)&child->errors, on_handle_closed);
    uv_close((uv_handle_t *)&child->process, on_handle_closed);
}

static void on_handle_closed(uv_handle_t *handle)
{
    struct worker_child *child = handle->data;

    if (--child->open_handles > 0) return;
    message_stream_finish(&child->stream);
    free(child);
}
