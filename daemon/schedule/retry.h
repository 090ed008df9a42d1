// Reactions to faults: whether a frame is tried again, and when a slot starts its next worker.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum retry_fault {
    RETRY_FAULT_JOB,    // no frame of the job can be rendered
    RETRY_FAULT_FRAME,  // this frame failed
    RETRY_FAULT_WORKER, // the worker lost its GL context and exits
    RETRY_FAULT_OUTPUT, // the disk is full or not writable: every frame would fail
    RETRY_FAULT_ROOT,   // the output root is not there
    RETRY_FAULT_LOST,   // the worker died, or was killed over one of its time limits
    // The frame does not end: a ray march takes more iterations than GL runs, or the worker was killed over the limit
    // of a frame's time, or, in a scene with GLSL of the user, of its progress or of the median. The next attempt would
    // most likely not end either, and each attempt holds a worker: the frame is failed at once.
    RETRY_FAULT_ENDLESS,
    RETRY_FAULT_CUT,   // cut paths may have lost too much light; the next attempt would cut the same
    RETRY_FAULT_MISSED // it misses its tolerance even when rendered finer; the next attempt would miss it too
};

// "job", "frame", "worker", "output", "root", "lost", "endless", "cut", "missed"; ends in NULL
extern const char *const retry_fault_names[];

enum retry_action {
    RETRY_FRAME,      // queue_fail, not final
    RETRY_FREE,       // queue_return: the attempt does not count
    RETRY_FAIL_FRAME, // queue_fail, final
    RETRY_FAIL_JOB,   // queue_fail_job
    RETRY_PAUSE_JOB,  // queue_return and queue_pause; the text of the fault becomes the job's reason
    RETRY_AWAIT_ROOT  // queue_return, and no frame of the job is taken until its output root is there
};

// `is_started`: the worker had begun the frame; a frame that was only assigned is not to blame. `tries` includes the
// attempt that failed (struct queue_frame).
enum retry_action retry_decide(enum retry_fault fault, bool is_started, int tries, int max_attempts);

// Whether a fault in a worker that was started for another job says nothing of this job: the worker's fence, or what
// the other job left in it, may be the cause. Then the frame is tried again in a worker of its own, as by RETRY_FREE.
bool retry_blames_host(enum retry_fault fault);

enum { RETRY_HOPELESS_LIMIT = 3 };

// Whether a job is failed as a whole after a frame was failed for RETRY_FAULT_LOST or a later fault of the enum: when
// RETRY_HOPELESS_LIMIT frames failed and none is done, its other frames are not tried.
bool retry_gives_up_job(int64_t failed, int64_t done);

// The wait of a slot whose workers do not start, or die before they finish a frame. The zero value does not wait.
struct retry_backoff {
    int failures;     // consecutive
    int64_t until_ms; // no start before it
};

void retry_backoff_fail(struct retry_backoff *backoff, int64_t now_ms); // waits 1 s, then 2, 4, ... 60 s
void retry_backoff_succeed(struct retry_backoff *backoff); // to be called when a frame is finished or skipped
int64_t retry_backoff_wait_ms(const struct retry_backoff *backoff, int64_t now_ms); // 0: start now
