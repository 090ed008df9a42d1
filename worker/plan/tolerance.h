// Keeps a job's tolerance: plans segments, renders and audits frames, and renders a frame over the tolerance once more.
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

struct tolerance *tolerance_create(struct renderer *renderer); // borrowed; outlives the tolerance
void tolerance_destroy(struct tolerance *tolerance);           // accepts NULL

struct tolerance_params {
    const struct job *job; // borrowed for the call
    int64_t serial;        // identifies the job: plans are kept by it, and no two jobs have the same
    int32_t frame;
    struct image *image; // as renderer_render takes it
    enum plan_choice choice;
    renderer_progress *on_progress;            // may be NULL; called at least every second, except while GL compiles
    void (*on_plan)(void *user, bool is_made); // may be NULL; called before a plan is made, and after
    void *user;
};

struct tolerance_result {
    struct renderer_result render; // of the last rendering; its seconds are those of all renderings
    struct job_quality quality;    // of the last rendering
    struct audit_result audit;     // AUDIT_NONE: the job states no tolerance
    char reason[PLAN_REASON_SIZE]; // of the plan; empty: the job names its method
    bool is_second;                // rendered twice: the first rendering was over the tolerance
    double first_error;            // the audited error of the first rendering
};

// Renders a frame of a job of any method, as renderer_render does, with the same faults. A frame that is over its
// tolerance in finer steps too fails with RENDERER_FAULT_MISSED and the numbers.
bool tolerance_render(struct tolerance *tolerance, const struct tolerance_params *params,
                      struct tolerance_result *result, struct error *error);

// By how many rungs each axis is refined for the second rendering, after a first one with that audited error. Two rungs
// halve a step. The aim is an error of half the tolerance, for errors of order 1.5. There are only three answers,
// because an audit is no more exact than that. Pure.
int tolerance_find_retry_rungs(double error, double tolerance);
