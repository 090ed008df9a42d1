// SPDX-License-Identifier: Apache-2.0
#include "node/node_pipe.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_write.h"
#include "core/wire/message_stream.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct node_pipe {
    const struct node_pipe_handlers *handlers; // borrowed; outlive us
    void *user;
    uv_pipe_t in, out;
    int open_handles;
    struct message_stream stream; // owned
    uint64_t heard_ms;
    uint64_t said_bytes, taken_bytes,
        taken_ms; // in all; of them that the other end has read; when that was seen to grow
    bool is_closed;
};

struct pipe_write {
    uv_write_t request;
    char bytes[];
};

static void on_allocate(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer)
{
    struct node_pipe *pipe = handle->data;
    size_t room;
    char *bytes = message_stream_reserve(&pipe->stream, &room);

    *buffer = uv_buf_init(bytes, (unsigned)(room < suggested ? room : suggested));
}

static void end(struct node_pipe *pipe, const struct error *error)
{
    uv_read_stop((uv_stream_t *)&pipe->in);
    pipe->handlers->on_end(pipe->user, error);
}

static void hand_on_lines(struct node_pipe *pipe)
{
    struct error error = {0};
    const char *line;
    size_t length;

    while (!pipe->is_closed && (line = message_stream_next(&pipe->stream, &length, &error)))
        if (!pipe->handlers->on_line(pipe->user, line, length, &error)) break;
    if (!pipe->is_closed && error.message[0]) end(pipe, &error);
}

static void on_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buffer)
{
    struct node_pipe *pipe = stream->data;

    if (count > 0) {
        pipe->heard_ms = uv_now(stream->loop);
        message_stream_commit(&pipe->stream, (size_t)count);
        hand_on_lines(pipe);
    } else if (count < 0) {
        end(pipe, &(struct error){0});
    }
}

static bool open_end(uv_pipe_t *end, int fd, struct error *error)
{
    struct stat facts;
    bool is_stream = fstat(fd, &facts) == 0 && (S_ISFIFO(facts.st_mode) || S_ISSOCK(facts.st_mode));
    int status = is_stream ? uv_pipe_open(end, fd) : UV_ENOTSOCK; // a file would end the loop

    if (status == 0) return true;
    error_set(error, "expected a pipe or a socket: %s", uv_strerror(status));
    close(fd);
    return false;
}

struct node_pipe *node_pipe_open(uv_loop_t *loop, int in_fd, int out_fd, size_t line_limit,
                                 const struct node_pipe_handlers *handlers, void *user, struct error *error)
{
    struct node_pipe *pipe = xcalloc(1, sizeof *pipe);
    bool is_open;

    pipe->handlers = handlers;
    pipe->user = user;
    pipe->open_handles = 2;
    pipe->heard_ms = pipe->taken_ms = uv_now(loop);
    pipe->stream.limit_bytes = line_limit + NODE_LINE_HEAD_SIZE;
    uv_pipe_init(loop, &pipe->in, 0);
    uv_pipe_init(loop, &pipe->out, 0);
    pipe->in.data = pipe->out.data = pipe;
    is_open = open_end(&pipe->in, in_fd, error);
    is_open = open_end(&pipe->out, out_fd, error) && is_open;
    if (!is_open) {
        node_pipe_close(pipe);
        return NULL;
    }
    uv_read_start((uv_stream_t *)&pipe->in, on_allocate, on_read);
    return pipe;
}

static void on_closed(uv_handle_t *handle)
{
    struct node_pipe *pipe = handle->data;

    if (--pipe->open_handles > 0) return;
    message_stream_finish(&pipe->stream);
    free(pipe);
}

void node_pipe_close(struct node_pipe *pipe)
{
    pipe->is_closed = true;
    uv_close((uv_handle_t *)&pipe->in, on_closed);
    uv_close((uv_handle_t *)&pipe->out, on_closed);
}

// A write fails only when the other end is gone; the end of the stream, or its silence, reports that.
static void on_written(uv_write_t *request, int status)
{
    free((struct pipe_write *)request);
}

static struct pipe_write *reserve(size_t length)
{
    return xmalloc(sizeof(struct pipe_write) + length);
}

static void push(struct node_pipe *pipe, struct pipe_write *write, size_t length)
{
    uv_buf_t buffer = uv_buf_init(write->bytes, (unsigned)length);

    pipe->said_bytes += length;
    if (pipe->is_closed || uv_write(&write->request, (uv_stream_t *)&pipe->out, &buffer, 1, on_written) != 0)
        free(write);
}

static size_t put_line(char *bytes, const char *head, size_t head_length, const char *rest, size_t length)
{
    memcpy(bytes, head, head_length);
    memcpy(bytes + head_length, rest, length);
    bytes[head_length + length] = '\n';
    return head_length + length + 1;
}

void node_pipe_say(struct node_pipe *pipe, enum node_word word, int worker, const char *rest, size_t length)
{
    char head[NODE_LINE_HEAD_SIZE];
    size_t head_length = node_line_write_head(head, word, worker);
    struct pipe_write *write = reserve(head_length + length + 1);

    push(pipe, write, put_line(write->bytes, head, head_length, rest, length));
}

void node_pipe_say_text(struct node_pipe *pipe, enum node_word word, int worker, const char *text)
{
    struct json_writer writer = {0};

    json_write_string(&writer, text);
    node_pipe_say(pipe, word, worker, writer.text, writer.length);
    json_writer_finish(&writer);
}

static size_t count_lines(const char *lines, size_t length)
{
    size_t count = 0;

    for (size_t i = 0; i < length; i++)
        count += lines[i] == '\n';
    return count;
}

void node_pipe_say_lines(struct node_pipe *pipe, enum node_word word, int worker, const char *lines, size_t length)
{
    char head[NODE_LINE_HEAD_SIZE];
    size_t head_length = node_line_write_head(head, word, worker), used = 0;
    struct pipe_write *write = reserve(length + count_lines(lines, length) * head_length);

    for (size_t start = 0; start < length;) {
        const char *newline = memchr(lines + start, '\n', length - start);
        size_t line = newline ? (size_t)(newline - lines) - start : length - start;

        used += put_line(write->bytes + used, head, head_length, lines + start, line);
        start += line + 1;
    }
    push(pipe, write, used);
}

int64_t node_pipe_silent_ms(const struct node_pipe *pipe)
{
    return (int64_t)(uv_now(pipe->in.loop) - pipe->heard_ms);
}

size_t node_pipe_waiting_bytes(const struct node_pipe *pipe)
{
    return uv_stream_get_write_queue_size((const uv_stream_t *)&pipe->out);
}

int64_t node_pipe_stuck_ms(struct node_pipe *pipe)
{
    size_t waiting = node_pipe_waiting_bytes(pipe);
    uint64_t now_ms = uv_now(pipe->in.loop);

    if (waiting == 0 || pipe->said_bytes - waiting != pipe->taken_bytes) {
        pipe->taken_bytes = pipe->said_bytes - waiting;
        pipe->taken_ms = now_ms;
    }
    return (int64_t)(now_ms - pipe->taken_ms);
}
