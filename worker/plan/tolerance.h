// Keeps a job's tolerance: plans segments, renders and audits frames, and renders a frame over the tolerance again.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/frame_phase.h"
#include "worker/picture/audit_result.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_params.h"
#include "worker/render/renderer.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct image;
struct plan_source;
struct tolerance;

struct tolerance *tolerance_create(struct renderer *renderer); // borrowed; outlives the tolerance
void tolerance_destroy(struct tolerance *tolerance);           // accepts NULL

struct tolerance_params {
    const struct job *job; // borrowed, as long as frames of its serial are rendered
    int64_t serial;        // identifies the job: plans are kept by it, and no two jobs have the same
    int32_t frame;
    struct image *image; // as renderer_render takes it
    enum plan_choice choice;
    const struct plan_source *source; // where plans are kept; NULL: they are made and numbered here
    // NULL, or the settings of a frame that was rendered before, and the number of its plan: nothing is planned, and
    // the frame is rendered once. One that is over the tolerance is marked as missed.
    const struct job_quality *repeated;
    int64_t repeated_number;
    struct job_beyond repeated_beyond; // what that file says of it
    // May be NULL; called at least every second, except while GL compiles, with the share of the phase that is done, or
    // 0 where that is not known.
    renderer_progress *on_progress;
    picture_level_callback *on_level;                     // as renderer_render takes it
    void (*on_phase)(void *user, enum frame_phase phase); // may be NULL; called before each plan, rendering and audit
    // May be NULL; called after a plan was made here, with the seconds that a frame's rendering is to take, where
    // random paths take most of them; else 0.
    void (*on_planned)(void *user, double render_s);
    void *user;
};

struct tolerance_result {
    // Of the rendering that is in the image: the last one, or the one with the least error if none kept the tolerance.
    // Its seconds are those of all renderings.
    struct renderer_result render;
    struct job_quality quality;    // of that rendering
    struct audit_result audit;     // likewise; AUDIT_NONE: the job states no tolerance
    char reason[PLAN_REASON_SIZE]; // of the plan; empty: the job names its method
    struct job_beyond beyond;      // what the job's orders of scattering leave out: measured once a plan, or a job
    int64_t plan_number;           // of the plan with which the frame began; 0: none
    double weight;                 // of the frame, as plan_frame_weight has it; 0: the job names its method
    int retry_count;               // renderings after the first, which was over the tolerance
    double first_error;            // the audited error of the first rendering; infinite: GL cut its loops
};

// Renders a frame of a job of any method, as renderer_render does, with the same faults. The frame follows from its
// job, its plan and its own pixels, never from the frames before it. A frame over its tolerance is rendered up to
// PLAN_RETRY_LIMIT times more, for as much work as plan_retry.h says: finer in what is to blame, or by
// the next family where that gains little. One whose loops GL cut is rendered in longer steps instead. What keeps the
// tolerance makes the segment's next plan, which later frames have. If nothing does, the frame fails with
// RENDERER_FAULT_MISSED and the numbers; with RENDERER_FAULT_ENDLESS where all renderings were cut. If the job has
// misses published, the rendering with the least error is in the image instead, and its audit says is_missed where that
// error is over the tolerance. Light that is not finite fails the frame with RENDERER_FAULT_FRAME before an audit.
bool tolerance_render(struct tolerance *tolerance, const struct tolerance_params *params,
                      struct tolerance_result *result, struct error *error);
