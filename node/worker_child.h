// One worker process as a child of this program: its start, its lines, its log and its end.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <uv.h>

struct error;
struct worker_child;

enum { WORKER_CHILD_LOG_BYTES = 4096 };        // at most so much of the log at once
enum { WORKER_CHILD_LINE_LIMIT = 256 * 1024 }; // bytes of a message, which is read on the loop; a plan is the longest

struct worker_child_params {
    const char *program, *backend; // borrowed during the call, as all strings
    const char *device;            // as --device of march-worker; NULL: its choice
    const char *shader_folder;     // NULL: the shaders inside the worker
    int thread_count;
    int64_t memory_bytes; // limit of its memory; 0: none
    bool has_sandbox;
    bool is_fenced; // its first line is the message worker.fence
};

struct worker_child_handlers {
    // A line of the worker, without its newline, valid during the call. False: no more lines are wanted.
    bool (*on_line)(void *user, const char *line, size_t length);
    void (*on_overlong)(void *user, const struct error *error); // no more lines come
    void (*on_log)(void *user, const char *bytes, size_t count);
    // The process is reaped and its output is read; the callee closes it. `signal` is 0 where it exited by itself.
    // `reason` is set where not the process but the way to it ended; a child's is NULL.
    void (*on_end)(void *user, int64_t status, int signal, const char *reason);
};

// Starts it in a session of its own, with its standard error and its messages on pipes to this program. NULL on
// failure, with the cause. `handlers` is borrowed and outlives the child.
struct worker_child *worker_child_start(uv_loop_t *loop, const struct worker_child_params *params,
                                        const struct worker_child_handlers *handlers, void *user, struct error *error);
int worker_child_pid(const struct worker_child *child);
void worker_child_send(struct worker_child *child, const char *bytes, size_t count); // copies
void worker_child_kill(struct worker_child *child);                                  // with SIGKILL
// To be called several times a second. What is wrong, if it is to be killed, else NULL; on_end may come.
const char *worker_child_check(struct worker_child *child);
// Has on_log called for what waits to be read: text from before a line may arrive after it, on another pipe.
void worker_child_read_log(struct worker_child *child);
void worker_child_close(struct worker_child *child); // no handler is called any more; it frees itself
