// What the worker says of its frames, as messages.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct assignment_frame;
struct assignment_dropped;
struct connection;
struct frame_accuracy;
struct gl_context_facts;
struct published_file;

// `facts` NULL: without a context; `sandbox`: what it sees to.
void report_ready(struct connection *connection, const struct gl_context_facts *facts, const char *sandbox);
// `fault` is "worker", or what of the job it could not be fenced in for: "job", its inputs, or "output".
void report_unable(struct connection *connection, const char *fault, const char *reason);
void report_beat(struct connection *connection, uint64_t progress);
void report_started(struct connection *connection, const struct assignment_frame *frame);
// A plan for the frame's part of the animation is being made, which may take longer than the frame; or is made.
void report_planning(struct connection *connection, const struct assignment_frame *frame);
void report_planned(struct connection *connection, const struct assignment_frame *frame);
void report_rendered(struct connection *connection, const struct assignment_frame *frame);

struct report_result {
    const struct published_file *file; // borrowed for the call, as what follows
    const struct frame_accuracy *accuracy;
    double render_s, encode_s;
    double audit_s; // that comparing its pixels took; 0: none were
};

void report_finished(struct connection *connection, const struct assignment_frame *frame,
                     const struct report_result *result);
// Without seconds: nothing was rendered.
void report_skipped(struct connection *connection, const struct assignment_frame *frame,
                    const struct report_result *result);
void report_dropped(struct connection *connection, const struct assignment_dropped *dropped);

enum report_fault {
    REPORT_FAULT_JOB,     // no frame of it can work
    REPORT_FAULT_FRAME,   // this one does not
    REPORT_FAULT_WORKER,  // the context is lost: another worker may do
    REPORT_FAULT_OUTPUT,  // the disk is full or may not be written
    REPORT_FAULT_ENDLESS, // this one does not, nor would it another time
    REPORT_FAULT_CUT,     // likewise: more of its light may be missing than the job allows
    REPORT_FAULT_MISSED   // likewise: it was over its tolerance after the finer rendering, too
};

// Logs the reason too: the log is what a user reads of an attempt.
void report_frame_failed(struct connection *connection, const struct assignment_frame *frame, enum report_fault fault,
                         const char *reason);
