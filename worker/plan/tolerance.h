// Keeps a job's tolerance: plans a segment, renders, audits, renders again what missed, and gives up what misses again.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/picture/audit_result.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_params.h"
#include "worker/render/renderer.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct image;
struct tolerance;

struct tolerance *tolerance_create(struct renderer *renderer); // which outlives us
void tolerance_destroy(struct tolerance *tolerance);           // accepts NULL

struct tolerance_params {
    const struct job *job; // borrowed for the call
    int64_t serial;        // of the job: plans are kept for it, so that two jobs never share one
    int32_t frame;
    struct image *image; // as renderer_render takes it
    enum plan_choice choice;
    renderer_progress *on_progress;            // may be NULL; called at least every second, but for what GL compiles
    void (*on_plan)(void *user, bool is_made); // may be NULL; called before a plan is made, and once it is
    void *user;
};

struct tolerance_result {
    struct renderer_result render; // of the last rendering, with all seconds that were rendered
    struct job_quality quality;    // that it was rendered with
    struct audit_result audit;     // AUDIT_NONE: the job states no tolerance
    char reason[PLAN_REASON_SIZE]; // of the plan; empty: the job says how
    bool is_second;                // the first rendering was over the tolerance
    double first_error;            // of the audit of the first
};

// As renderer_render, whose faults it has, for a job of any method. RENDERER_FAULT_MISSED, with the numbers, when the frame is
// over its tolerance in finer steps, too.
bool tolerance_render(struct tolerance *tolerance, const struct tolerance_params *params,
                      struct tolerance_result *result, struct error *error);

// How much finer the second rendering is than a first one of that audited error, over the tolerance: rungs of each axis, two halving
// a step. In few classes, as an audit is but near: of order three halves, which kinks leave of two, the error comes to half the
// tolerance, as far as there are classes for it. Pure.
int tolerance_find_retry_rungs(double error, double tolerance);
