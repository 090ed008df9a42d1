// Whether a worker still works, by clocks: start-up, heartbeat, progress, and run time against the job's median.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Zero members take the defaults.
struct liveness_limits {
    int64_t start_ms;     // from process start to worker.ready; 30 s
    int64_t heartbeat_ms; // since its last message; 10 s
    int64_t progress_ms;  // with frames in hand and the same progress; 120 s
    int64_t run_ms;       // a frame may always render this long; 60 s
    double run_factor;    // and this many times the median of its job; 20
};

enum { LIVENESS_KNOWN_FRAMES = 5 }; // durations a median needs before a frame is held against it

enum liveness_verdict { LIVENESS_ALIVE, LIVENESS_NO_START, LIVENESS_SILENT, LIVENESS_STUCK, LIVENESS_OVERLONG };

// One a worker process. Times are of one monotonic clock.
struct liveness {
    struct liveness_limits limits; // borrowed values; set before liveness_start
    bool is_ready;
    bool is_busy;
    bool is_rendering;
    double progress;
    int64_t started_ms;       // the process
    int64_t last_message_ms;  // its newest message
    int64_t last_progress_ms; // its newest progress, or when it got work
    int64_t rendering_ms;     // the frame it renders began
    int64_t checked_ms;
};

void liveness_start(struct liveness *liveness, int64_t now_ms); // the process was started; keeps `limits`
// Each message calls the one below that fits it; liveness_note_message for those that have none.
void liveness_note_message(struct liveness *liveness, int64_t now_ms);
void liveness_ready(struct liveness *liveness, int64_t now_ms);                     // worker.ready
void liveness_progress(struct liveness *liveness, double progress, int64_t now_ms); // worker.beat
void liveness_begin_frame(struct liveness *liveness, int64_t now_ms);               // frame.started, .planned
void liveness_end_frame(struct liveness *liveness, int64_t now_ms); // frame.rendered, .skipped, .failed, .planning
// Whether any frame is in its hand, rendering or encoding; not a message. Only a busy worker must make progress, and
// one with empty hands renders nothing.
void liveness_set_busy(struct liveness *liveness, bool is_busy, int64_t now_ms);

enum { LIVENESS_REASON_SIZE = 160 };

// To be called about once a second. `median_s` of `known` durations belongs to the job of the frame it renders. On
// anything but LIVENESS_ALIVE `reason` says what was missed, as in "no message for 10 s". When the caller itself is
// late (stopped, or its loop blocked), the clocks stand still for that time: what it did not read is no silence.
enum liveness_verdict liveness_check(struct liveness *liveness, double median_s, size_t known, int64_t now_ms,
                                     char reason[static LIVENESS_REASON_SIZE]);
