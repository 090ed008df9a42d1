// What follows a fault: whether a frame is tried again, and when a slot starts its next worker.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum retry_fault {
    RETRY_FAULT_JOB,    // no frame of the job can work
    RETRY_FAULT_FRAME,  // this frame did not work
    RETRY_FAULT_WORKER, // the worker lost its context; it exits
    RETRY_FAULT_OUTPUT, // disk full or not writable: every frame would meet it
    RETRY_FAULT_LOST,   // the worker died, or was killed by one of its clocks
    // The frame does not end: its march takes more turns than GL runs, or it was killed by the clock of its progress or of
    // its frame in a scene with code of the user's own. It would most likely not end the next time either, and each try
    // holds a worker: so the frame is failed at once.
    RETRY_FAULT_ENDLESS,
    RETRY_FAULT_CUT,   // cut rays may have taken too much of its light; the next try would cut the same
    RETRY_FAULT_MISSED // it is over its tolerance, rendered finer as well; the next try would be the same
};

// "job", "frame", "worker", "output", "lost", "endless", "cut", "missed"; ends in NULL
extern const char *const retry_fault_names[];

enum retry_action {
    RETRY_FRAME,      // queue_fail, not final
    RETRY_FREE,       // queue_return: the attempt does not count
    RETRY_FAIL_FRAME, // queue_fail, final
    RETRY_FAIL_JOB,   // queue_fail_job
    RETRY_PAUSE_JOB   // queue_return and queue_pause, the fault's text as the job's reason
};

// `is_started`: the worker had begun the frame; what only waited in its hand is not to blame. `tries` counts the
// attempt that failed (struct queue_frame).
enum retry_action retry_decide(enum retry_fault fault, bool is_started, int tries, int max_attempts);

enum { RETRY_HOPELESS_LIMIT = 3 };

// Whether a job is failed as a whole, after a frame was failed for RETRY_FAULT_LOST or a fault after it: when so many frames
// failed and none was ever made, workers are not spent on the others.
bool retry_gives_up_job(int64_t failed, int64_t done);

// Of a slot whose worker cannot start, or dies before it finishes a frame. The zero value waits for nothing.
struct retry_backoff {
    int failures;     // in a row
    int64_t until_ms; // no start before
};

void retry_backoff_fail(struct retry_backoff *backoff, int64_t now_ms); // waits 1 s, then 2, 4, ... 60
void retry_backoff_succeed(struct retry_backoff *backoff);              // when a frame is finished or skipped
int64_t retry_backoff_wait_ms(const struct retry_backoff *backoff, int64_t now_ms); // 0: start now
