// The parameters of planning: a renderer, a job, and the segment of its frames.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/plan/plan_segment.h"
#include "worker/render/renderer.h"

#include <stdbool.h>

struct job;
struct plan_evidence;
struct truth;

enum plan_choice {
    PLAN_CHOICE_CHEAPEST, // the setting with the least work that keeps the tolerance
    PLAN_CHOICE_COARSEST, // for tests: the same method at its coarsest, whatever the error
    PLAN_CHOICE_FINEST    // for tests: the same method, every step an eighth as long
};

struct plan_params {
    struct renderer *renderer; // borrowed
    const struct job *job;     // borrowed; of method auto
    struct plan_segment segment;
    enum plan_choice choice;
    bool is_timed;                  // predicts seconds too, by rendering some frames larger
    struct plan_evidence *evidence; // NULL, or where to leave the evidence for audits; empty before
    struct truth **truth;           // NULL, or where to leave a truth of the planned job, if one is opened; NULL before
    double *done;                   // NULL, or where to note how much of the plan is made, from 0 to 1
    bool is_scattered;              // the plan is one of several orders of scattering: its progress counts their stages
    bool tells_renders;             // without `done`: on_progress is told the share of each render that is done
    renderer_progress *on_progress; // may be NULL; called with what `done` has, else 0; false stops
    void *user;
};
