// Whether a worker is alive, by its time limits: start, heartbeat, progress, and the time of a frame.
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

// What is known of the job whose frame is rendered. The zero value limits nothing.
struct liveness_job {
    double median_s; // of `known` durations of its frames
    size_t known;
    int64_t stated_limit_ms; // of an attempt, stated by the job: the median limits none then; 0: none
    int64_t limit_ms;        // of an attempt where the job states none, and of planning in an attempt; 0: none
};

enum liveness_verdict {
    LIVENESS_ALIVE,
    LIVENESS_SLOW, // it is alive: a frame takes 5 medians and 10 s by now; told once an attempt
    LIVENESS_NO_START,
    LIVENESS_SILENT,
    LIVENESS_STUCK,
    LIVENESS_OVERLONG, // of the median
    LIVENESS_OVER_LIMIT
};

// One per worker process. Times are of one monotonic clock.
struct liveness {
    struct liveness_limits limits; // set before liveness_start
    bool is_ready;
    bool is_busy;
    bool is_rendering, is_planning;
    bool is_slow; // LIVENESS_SLOW was told about the attempt
    double progress;
    int64_t started_ms;       // start of the process
    int64_t last_message_ms;  // latest message
    int64_t last_progress_ms; // latest progress, or assignment to an idle worker
    int64_t rendering_ms;     // start of the frame that is being rendered, or of its plan, or end of its plan
    int64_t rendered_ms;      // time that the attempt took before that, without plans
    int64_t planned_ms;       // time of its plans before that
    int64_t checked_ms;
};

void liveness_start(struct liveness *liveness, int64_t now_ms); // at the start of the process; keeps `limits`
// Each message of the worker calls one of these: the one for its method, else liveness_note_message.
void liveness_note_message(struct liveness *liveness, int64_t now_ms);
void liveness_ready(struct liveness *liveness, int64_t now_ms);                     // worker.ready
void liveness_progress(struct liveness *liveness, double progress, int64_t now_ms); // worker.beat
void liveness_begin_frame(struct liveness *liveness, int64_t now_ms);               // frame.started
void liveness_begin_plan(struct liveness *liveness, int64_t now_ms);                // frame.planning
void liveness_end_plan(struct liveness *liveness, int64_t now_ms);                  // frame.planned
void liveness_end_frame(struct liveness *liveness, int64_t now_ms);                 // frame.rendered, .skipped, .failed
// Sets whether frames are in flight; this is no message. Only a busy worker must make progress.
void liveness_set_busy(struct liveness *liveness, bool is_busy, int64_t now_ms);

enum { LIVENESS_REASON_SIZE = 160 };

// To be called about once a second, with what is known of the job that is being rendered. On any verdict but
// LIVENESS_ALIVE `reason` names the exceeded limit, as in "no message for 10 s". When the caller is late (stopped, or
// its loop blocked), its delay does not count: messages may be waiting unread.
enum liveness_verdict liveness_check(struct liveness *liveness, const struct liveness_job *job, int64_t now_ms,
                                     char reason[static LIVENESS_REASON_SIZE]);
