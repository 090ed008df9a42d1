// One worker process: its start, its messages both ways, what it holds, its last words and its end.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/log.h"
#include "core/wire/message_stream.h"
#include "daemon/schedule/in_flight.h"
#include "daemon/schedule/liveness.h"
#include "daemon/workers/worker_report.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <uv.h>

struct error;
struct job_record;
struct json_writer;
struct worker_process;

enum { WORKER_LOG_BYTES = 8192, WORKER_ANY_JOB = 0, WORKER_NO_JOB = -1 };

enum worker_state {
    WORKER_STARTING,
    WORKER_READY,
    WORKER_STOPPING // it was told to exit, or said that it will
};

struct worker_handlers {
    void (*on_report)(void *user, struct worker_process *worker, const struct worker_report *report);
    // It is reaped and all it said is read; the callee closes it.
    void (*on_gone)(void *user, struct worker_process *worker);
    void *user;
};

struct worker_params {
    const char *program, *backend, *shader_folder; // borrowed during the call; shader_folder may be NULL
    int thread_count;
    int64_t progress_limit_ms;
    int id; // of its slot
    bool has_sandbox;
    int64_t memory_bytes;            // that it may allocate; 0: any amount
    int64_t job;                     // that alone it serves, fenced in; 0: any
    const struct json_writer *fence; // of that job; borrowed during the call
};

// Open for reading; changed by this module and by who hands it frames.
struct worker_process {
    int id;
    enum worker_state state;
    int64_t job;                            // that alone it serves; WORKER_ANY_JOB, or WORKER_NO_JOB: that job is over
    int64_t next_job;                       // that it makes room for; 0: none
    bool is_replaced;                       // its end is no fault of its own: another takes its place
    int64_t memory_bytes;                   // that it may allocate; 0: any amount
    const struct worker_handlers *handlers; // borrowed; outlive us
    char *backend, *vendor, *renderer, *version, *device_uuid, *sandbox; // owned; NULL until ready
    struct in_flight in_flight;
    int64_t *known_jobs; // owned; whose worker.job it was sent
    size_t known_count, known_capacity;
    struct liveness liveness;
    uint64_t answered_ns;           // when it last answered for a frame, or got one with empty hands
    int64_t done;                   // frames it finished or skipped
    int64_t stop_by_ms;             // monotonic; killed after it while stopping
    const char *suspect_code;       // borrowed; the user's code whose frame a clock killed it for; NULL: none
    char *end_reason;               // owned; why it was killed or says it cannot work; NULL: not known
    char log[WORKER_LOG_BYTES + 1]; // the end of what it wrote to standard error and no attempt has been told
    size_t log_length;

    // The module's own.
    uv_process_t process;
    uv_pipe_t channel, errors;
    int open_handles;
    struct message_stream stream;
    bool has_exited, has_channel_ended, has_errors_ended, is_gone;
    int64_t exit_status;
    int exit_signal;
    int64_t ended_ms; // when its exit, or the end of its channel, was seen first
};

// NULL on failure, with the cause.
struct worker_process *worker_process_start(uv_loop_t *loop, const struct worker_params *params,
                                            const struct worker_handlers *handlers, struct error *error);
struct log_subject worker_process_subject(const struct worker_process *worker); // it, and the frame that it renders
int worker_process_pid(const struct worker_process *worker);
// Ends it with SIGKILL; `reason` goes into the log of the attempts it held.
void worker_process_kill(struct worker_process *worker, const char *reason);
void worker_process_exit(struct worker_process *worker,
                         int64_t stop_by_ms); // worker.exit, and killed if it has not by then
void worker_process_expect_exit(struct worker_process *worker, int64_t stop_by_ms); // the same without a word to it
void worker_process_check(struct worker_process *worker, int64_t now_ms);           // to be called now and then
void worker_process_close(struct worker_process *worker); // frees itself once its handles are closed

void worker_process_send(struct worker_process *worker, const struct json_writer *messages);
// "exit status 1", "killed: no message for 10 s", ... ; owned by the caller.
char *worker_process_describe_end(const struct worker_process *worker);
// The reason, if any, and the last lines it wrote, which are then forgotten; owned by the caller.
char *worker_process_take_log(struct worker_process *worker, const char *reason);
void worker_process_forget_log(struct worker_process *worker);
bool worker_process_knows_job(const struct worker_process *worker, int64_t job);
void worker_process_learn_job(struct worker_process *worker, int64_t job);
void worker_process_forget_job(struct worker_process *worker, int64_t job);
