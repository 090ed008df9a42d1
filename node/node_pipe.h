// One end of a node's stream: lines in, lines out, and how long nothing was heard.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "node/node_line.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <uv.h>

struct error;
struct json_writer;
struct node_pipe;

struct node_pipe_handlers {
    // A line, valid during the call. False, with `error` set: it is none of a node; no more lines come.
    bool (*on_line)(void *user, const char *bytes, size_t length, struct error *error);
    // No more lines come; the callee closes the pipe. An empty error: the other end is closed.
    void (*on_end)(void *user, const struct error *error);
};

// A line has at most `line_limit` bytes behind its head. Takes over the two descriptors, pipes or sockets. NULL on
// failure, with the cause; they are then closed.
struct node_pipe *node_pipe_open(uv_loop_t *loop, int in_fd, int out_fd, size_t line_limit,
                                 const struct node_pipe_handlers *handlers, void *user, struct error *error);
void node_pipe_close(struct node_pipe *pipe); // no handler is called any more; it frees itself
// What is written is sent in order, however long that takes. `length` bytes of `rest` may not hold a newline.
void node_pipe_say(struct node_pipe *pipe, enum node_word word, int worker, const char *rest, size_t length);
void node_pipe_say_text(struct node_pipe *pipe, enum node_word word, int worker, const char *text); // as a JSON string
// Sends the lines of the messages, each as one of the worker.
void node_pipe_say_lines(struct node_pipe *pipe, enum node_word word, int worker, const char *lines, size_t length);
int64_t node_pipe_silent_ms(const struct node_pipe *pipe);    // since the other end was heard, or the start
size_t node_pipe_waiting_bytes(const struct node_pipe *pipe); // said, and not read by the other end
// For how long the other end has read nothing of what waits for it; 0: nothing waits. To be called often.
int64_t node_pipe_stuck_ms(struct node_pipe *pipe);
