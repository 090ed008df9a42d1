// Reports of a worker about itself and its frames, read from its messages.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/json/json_node.h"
#include "core/wire/frame_accuracy.h"
#include "core/wire/frame_phase.h"
#include "core/wire/publish.h"
#include "daemon/schedule/retry.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct message;

enum worker_report_kind {
    WORKER_REPORT_READY,
    WORKER_REPORT_UNABLE, // worker.failed
    WORKER_REPORT_BEAT,
    WORKER_REPORT_STARTED, // from here on: about a frame
    WORKER_REPORT_PLANNING,
    WORKER_REPORT_PLANNED,
    WORKER_REPORT_PHASE,
    WORKER_REPORT_PLAN_WANTED,
    WORKER_REPORT_PLAN_MADE,
    WORKER_REPORT_RENDERED,
    WORKER_REPORT_FINISHED,
    WORKER_REPORT_SKIPPED,
    WORKER_REPORT_FAILED,
    WORKER_REPORT_DROPPED,
    WORKER_REPORT_UNKNOWN // a method that the daemon does not know; not an error
};

// Strings are borrowed from the message.
struct worker_report {
    enum worker_report_kind kind;
    const char *backend, *vendor, *renderer, *version, *device_uuid; // ready; device_uuid may be NULL
    const char *sandbox;                                             // ready; the sandbox in force; may be NULL
    double progress;                                                 // beat
    int64_t job;                                                     // kinds about a frame
    int32_t frame, attempt;
    enum frame_phase phase;     // phase
    double phase_progress;      // phase: 0 to 1; negative: unknown
    const char *key;            // plan wanted, plan made: 32 hexadecimal digits
    int64_t missed;             // plan made: the number of the plan that it replaces; 0: none
    struct json_node plan;      // plan made; borrowed from the message
    int64_t planned_frames;     // planned: the frames that the plan serves; 0: unknown
    double foretold_s;          // planned: seconds of a frame's rendering by the plan; 0: unknown
    struct published_file file; // finished; skipped, without inode
    bool is_found;              // finished: the part file was there, nothing was rendered now
    double render_s, encode_s;
    double audit_s;                 // in addition to both
    double weight;                  // work relative to the mean of its segment's frames; 1: unknown
    struct frame_accuracy accuracy; // finished, skipped
    enum retry_fault fault;         // failed
    const char *error;              // failed, unable
};

bool worker_report_read(struct worker_report *report, const struct message *message, struct error *error);
