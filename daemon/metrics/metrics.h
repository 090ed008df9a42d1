// What the daemon counts of frames, plans and workers since its start. Pure, without an allocation for an event.
// SPDX-License-Identifier: Apache-2.0
//
// Whatever users do, the series are limited in number: labels are pools of the settings and words of fixed lists.
#pragma once

#include "daemon/metrics/histogram.h"
#include "daemon/schedule/retry.h"
#include "daemon/schedule/turns.h"

#include <stddef.h>
#include <stdint.h>

enum {
    METRICS_SERIES_LIMIT = 256, // combinations of pool, backend and method; what comes later shares one more
    METRICS_FAULT_COUNT = RETRY_FAULT_MISSED + 1
};

// Why a worker process ended.
enum metrics_end {
    METRICS_END_REPLACED,   // it made room for one that serves another job
    METRICS_END_STOPPED,    // it was told to exit, or announced it, and did
    METRICS_END_NODE,       // its node is lost
    METRICS_END_OVER_LIMIT, // it was killed over the time of a frame
    METRICS_END_MEMORY,     // it reached its limit of memory
    METRICS_END_NO_START,   // it ended before it was ready
    METRICS_END_KILLED,     // it was not heard, made no progress, or did not stop in time
    METRICS_END_DIED,       // by itself
    METRICS_END_COUNT
};

extern const char *const metrics_end_names[METRICS_END_COUNT];

// What a frame was rendered by.
struct metrics_source {
    int pool;            // kind of the worker's seat
    const char *backend; // as the worker names it; NULL: unknown
    const char *method;  // of the job's names, or "draft"
};

struct metrics_frame_series {
    int pool;
    int backend, method; // indices of names below
    struct histogram seconds, error;
};

// Kinds are those of seats. The zero value has counted nothing.
struct metrics {
    struct metrics_frame_series frames[METRICS_SERIES_LIMIT + 1]; // the last: of all that have no series
    size_t frame_count;                                           // series in use before the last
    double render_s, encode_s, audit_s;                           // of all frames
    struct histogram plan_s[TURNS_KIND_LIMIT];
    struct histogram publish_s, start_wait_s;
    uint64_t faults[TURNS_KIND_LIMIT][METRICS_FAULT_COUNT]; // of attempts that had begun
    uint64_t worker_ends[TURNS_KIND_LIMIT][METRICS_END_COUNT];
    uint64_t published, skipped, missed; // frames
    double published_bytes;
};

// A frame is done after so many seconds of a worker. `error` is relative to the tolerance; negative: unknown.
void metrics_note_frame(struct metrics *metrics, const struct metrics_source *source, double seconds, double error);

// "other" stands for what no list has.
const char *metrics_backend_name(int backend);
const char *metrics_method_name(int method);
