// The daemon's report about a job.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/exit_status.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct json_node;
struct progress;

// Texts are owned and may be NULL; unknown numbers are negative.
struct job_report {
    int64_t id, priority;
    int64_t frames, queued, running, succeeded, failed, canceled, skipped;
    int64_t missed; // of those that succeeded or were skipped: published over the tolerance
    char *name, *state, *owner, *range, *output, *reason, *phase, *comment, *pool;
    char *tags;  // "a, b"
    char *label; // "#7 cloud"
    bool is_draft;
    double submitted, started, finished; // unix s
    double seconds_per_frame, eta_s, phase_progress;
};

// `node` is a *job* of docs/protocol.md. The report must be empty; after a failure it is empty again.
bool job_report_read(struct job_report *report, const struct json_node *node, struct error *error);
void job_report_finish(struct job_report *report);
bool job_report_has_ended(const struct job_report *report);
bool job_report_is_next(const struct job_report *report);            // it waits for a worker, and for nothing else
enum exit_status job_report_status(const struct job_report *report); // the job must have ended
void job_report_fill_progress(const struct job_report *report,
                              struct progress *progress); // `progress` borrows the texts
