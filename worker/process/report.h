// The messages in which the worker reports on itself and its frames.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/frame_phase.h"

#include <stdbool.h>
#include <stdint.h>

struct assignment_frame;
struct assignment_dropped;
struct connection;
struct frame_accuracy;
struct gl_context_facts;
struct plan_json;
struct published_file;

// `facts` NULL: there is no context. `sandbox`: what the sandbox restricts.
void report_ready(struct connection *connection, const struct gl_context_facts *facts, const char *sandbox);
// `fault` is "worker", or why the worker could not be fenced in for its job: "job" (its inputs) or "output".
void report_unable(struct connection *connection, const char *fault, const char *reason);
void report_beat(struct connection *connection, uint64_t progress);
// What the rendering thread does to which frame. The zero value: nothing.
struct report_doing {
    int64_t job;
    int32_t frame;
    int attempt;
    enum frame_phase phase;
    double progress; // of the phase, 0 to 1; negative: unknown
};

// Does nothing in FRAME_PHASE_NONE.
void report_phase(struct connection *connection, const struct report_doing *doing);
// How many parts of the answer to a request are done, of how many, and how much of the next one, from 0 to 1.
void report_part(struct connection *connection, int64_t done, int64_t count, double share);
void report_started(struct connection *connection, const struct assignment_frame *frame);
// The plan of the frame's segment is being made, which may take longer than the frame; and has been made.
void report_planning(struct connection *connection, const struct assignment_frame *frame);
// It serves so many frames, and foretells the seconds of a frame's rendering; 0: not known.
void report_planned(struct connection *connection, const struct assignment_frame *frame, int64_t frame_count,
                    double render_s);
// The segment's plan is asked for; one was made.
void report_plan_wanted(struct connection *connection, const struct assignment_frame *frame, const char *key);

struct report_plan {
    const char *key;              // of the segment's scene
    int64_t missed;               // the number of the plan that it replaces; 0: none
    const struct plan_json *plan; // borrowed for the call
};

void report_plan_made(struct connection *connection, const struct assignment_frame *frame,
                      const struct report_plan *made);
void report_rendered(struct connection *connection, const struct assignment_frame *frame);

struct report_result {
    const struct published_file *file; // borrowed for the call, as is the next
    const struct frame_accuracy *accuracy;
    double render_s, encode_s;
    double audit_s; // of the audit; 0: there was none
    bool is_found;  // finished: the part file was there, nothing was rendered now
    double weight;  // work relative to the mean of its segment's frames; 0: unknown
};

void report_finished(struct connection *connection, const struct assignment_frame *frame,
                     const struct report_result *result);
// The seconds are not reported: nothing was rendered.
void report_skipped(struct connection *connection, const struct assignment_frame *frame,
                    const struct report_result *result);
void report_dropped(struct connection *connection, const struct assignment_dropped *dropped);

enum report_fault {
    REPORT_FAULT_JOB,     // no frame of the job can be rendered
    REPORT_FAULT_FRAME,   // this frame cannot
    REPORT_FAULT_WORKER,  // the context is lost: another worker may succeed
    REPORT_FAULT_OUTPUT,  // the disk is full or not writable
    REPORT_FAULT_ROOT,    // the output root is not there, or another folder is in its place
    REPORT_FAULT_ENDLESS, // this frame cannot be rendered, nor will it be another time
    REPORT_FAULT_CUT,     // likewise: cut rays may have cost more of its light than the job allows
    REPORT_FAULT_MISSED   // likewise: it was over its tolerance in the finer rendering too
};

// Logs the reason too, at debug level.
void report_frame_failed(struct connection *connection, const struct assignment_frame *frame, enum report_fault fault,
                         const char *reason);
