// One worker process: its start, messages, frames in flight, log and end.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/log.h"
#include "daemon/nodes/worker_link.h"
#include "daemon/schedule/in_flight.h"
#include "daemon/schedule/liveness.h"
#include "daemon/schedule/pace.h"
#include "daemon/workers/worker_report.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct job_fence;
struct json_writer;
struct node;
struct worker_process;

enum { WORKER_LOG_BYTES = 8192, WORKER_ANY_JOB = 0, WORKER_NO_JOB = -1 };

enum worker_state {
    WORKER_STARTING,
    WORKER_READY,
    WORKER_STOPPING // it was told to exit, or announced it
};

struct worker_handlers {
    void (*on_report)(void *user, struct worker_process *worker, const struct worker_report *report);
    // The process is reaped and its output is read; the callee closes it.
    void (*on_gone)(void *user, struct worker_process *worker);
    void *user;
};

struct worker_params {
    struct worker_child_params child;
    struct node *node; // borrowed; the ready node that it runs on; NULL: this machine
    int64_t progress_limit_ms;
    int id;                          // of the slot
    int64_t job;                     // the job that it is started for, inside its fence; 0: any job
    struct job_fence *fence;         // of that job; moves into the worker; NULL: none
    const struct json_writer *first; // the message worker.fence; borrowed during the call
};

// Read by others; changed by this module and the modules that assign frames.
struct worker_process {
    int id;
    enum worker_state state;
    int64_t job;             // the job that it was started for; WORKER_ANY_JOB; WORKER_NO_JOB: that job is over
    struct node *node;       // borrowed; where it runs; NULL: on this machine
    struct job_fence *fence; // owned; other jobs that it may serve; NULL: none, or any
    int64_t next_job;        // the job that it makes room for; 0: none
    bool is_replaced;        // it exits to make room: its end is no fault
    bool is_node_lost;       // it ended because its node did, or is not heard
    int64_t heartbeat_ms;    // within which a node that hears nothing ends its workers; 0: on this machine
    bool is_over_limit;      // it was killed over a limit of a frame's time
    int64_t memory_bytes;    // limit of its memory; 0: none
    const struct worker_handlers *handlers;                              // borrowed; outlive us
    char *backend, *vendor, *renderer, *version, *device_uuid, *sandbox; // owned; NULL until ready
    struct in_flight in_flight;
    int64_t *known_jobs; // owned; jobs whose worker.job was sent
    size_t known_count, known_capacity;
    struct liveness liveness;
    struct pace pace;
    int64_t done;                   // count of frames that it finished or skipped
    int64_t stop_by_ms;             // monotonic; it is killed then; 0: never
    const char *suspect_code;       // borrowed; the GLSL of the user whose frame it was killed over; NULL: none
    char *end_reason;               // owned; why it was killed or reported to be unable; NULL: unknown
    char log[WORKER_LOG_BYTES + 1]; // the end of its standard error, since the latest attempt took it
    size_t log_length;

    // For the module only.
    struct worker_link link;
    bool is_over; // it ended: there is nothing to kill
    int64_t exit_status;
    int exit_signal;
};

// NULL on failure, with the cause.
struct worker_process *worker_process_start(uv_loop_t *loop, const struct worker_params *params,
                                            const struct worker_handlers *handlers, struct error *error);
struct log_subject worker_process_subject(const struct worker_process *worker); // its id, and the frame that it renders
int worker_process_pid(const struct worker_process *worker);
const char *worker_process_node(const struct worker_process *worker); // its node's name; NULL: this machine
void worker_process_note_ready(struct worker_process *worker, const struct worker_report *report); // keeps its texts
void worker_process_note_clocks(struct worker_process *worker, const struct worker_report *report, int64_t now_ms);
// Whether it was started for another job than this one: its fence or its past may be why a frame fails.
bool worker_process_is_host(const struct worker_process *worker, int64_t job);
// Kills it with SIGKILL; `reason` goes into the log of its attempts.
void worker_process_kill(struct worker_process *worker, const char *reason);
// Sends worker.exit; the worker is killed at `stop_by_ms`.
void worker_process_exit(struct worker_process *worker, int64_t stop_by_ms);
void worker_process_expect_exit(struct worker_process *worker, int64_t stop_by_ms); // as above, without the message
// It did not find a root that may be there: if it is on a node, that has to look, and the worker makes room for one
// that is fenced into what is there now.
void worker_process_doubt_node(struct worker_process *worker, int64_t stop_by_ms);
void worker_process_check(struct worker_process *worker, int64_t now_ms); // to be called several times a second
void worker_process_close(struct worker_process *worker);                 // frees it

void worker_process_send(struct worker_process *worker, const struct json_writer *messages);
// "exit status 1", "killed: no message for 10 s", ... ; owned by the caller.
char *worker_process_describe_end(const struct worker_process *worker);
// Takes the log, after the line `reason` (may be NULL); owned by the caller.
char *worker_process_take_log(struct worker_process *worker, const char *reason);
void worker_process_forget_log(struct worker_process *worker);
bool worker_process_knows_job(const struct worker_process *worker, int64_t job);
void worker_process_learn_job(struct worker_process *worker, int64_t job);
void worker_process_forget_job(struct worker_process *worker, int64_t job);             // sends worker.forget
void worker_process_drop_job(struct worker_process *worker, int64_t job, bool running); // sends worker.drop
