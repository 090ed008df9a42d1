// Whether a worker is alive, by four time limits: start, heartbeat, progress, and the time of a frame.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Members that are 0 take the default.
struct liveness_limits {
    int64_t start_ms;     // from the start of the process to worker.ready; default 30 s
    int64_t heartbeat_ms; // since the last message; default 10 s
    int64_t progress_ms;  // without progress while frames are in flight; default 120 s
    int64_t run_ms;       // time that any frame may take; default 60 s
    double run_factor;    // or this many times the median of its job; default 20
};

enum { LIVENESS_KNOWN_FRAMES = 5 }; // durations that a median needs before it limits frames

enum liveness_verdict { LIVENESS_ALIVE, LIVENESS_NO_START, LIVENESS_SILENT, LIVENESS_STUCK, LIVENESS_OVERLONG };

// One per worker process. Times are of one monotonic clock.
struct liveness {
    struct liveness_limits limits; // set before liveness_start
    bool is_ready;
    bool is_busy;
    bool is_rendering;
    double progress;
    int64_t started_ms;       // start of the process
    int64_t last_message_ms;  // latest message
    int64_t last_progress_ms; // latest progress, or assignment to an idle worker
    int64_t rendering_ms;     // start of the frame that is being rendered
    int64_t checked_ms;
};

void liveness_start(struct liveness *liveness, int64_t now_ms); // at the start of the process; keeps `limits`
// Each message of the worker calls one of these: the one for its method, else liveness_note_message.
void liveness_note_message(struct liveness *liveness, int64_t now_ms);
void liveness_ready(struct liveness *liveness, int64_t now_ms);                     // worker.ready
void liveness_progress(struct liveness *liveness, double progress, int64_t now_ms); // worker.beat
void liveness_begin_frame(struct liveness *liveness, int64_t now_ms);               // frame.started, .planned
void liveness_end_frame(struct liveness *liveness, int64_t now_ms); // frame.rendered, .skipped, .failed, .planning
// Sets whether frames are in flight; this is no message. Only a busy worker must make progress.
void liveness_set_busy(struct liveness *liveness, bool is_busy, int64_t now_ms);

enum { LIVENESS_REASON_SIZE = 160 };

// To be called about once a second. `median_s` is the median of `known` durations of the job that is being rendered. On
// any verdict but LIVENESS_ALIVE `reason` names the exceeded limit, as in "no message for 10 s". When the caller is
// late (stopped, or its loop blocked), its delay does not count: messages may be waiting unread.
enum liveness_verdict liveness_check(struct liveness *liveness, double median_s, size_t known, int64_t now_ms,
                                     char reason[static LIVENESS_REASON_SIZE]);
