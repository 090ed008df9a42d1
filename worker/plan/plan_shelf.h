// The plans that a worker has at hand, of the latest segments: made here, or brought up to date with those of others.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "core/job/plan_json.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_evidence.h"
#include "worker/plan/plan_params.h"
#include "worker/render/renderer_fault.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct plan_source;
struct truth;

enum { PLAN_SHELF_LIMIT = 4 };

// A segment's plan, and the evidence and the reference that the audits of its frames share.
struct plan_kept {
    int64_t serial, segment; // serial 0: no plan
    uint64_t used;           // grows with every use of any plan: the smallest is the least recently used
    char key[HASH_TEXT_SIZE];
    int64_t newest_number; // 0: none
    struct plan_json newest;
    int64_t number; // of what follows; 0: none
    struct plan plan;
    struct plan_evidence evidence;
    struct truth *truth; // owned; NULL until the plan or an audit opens it, or without a twin
};

// The zero value is empty.
struct plan_shelf {
    struct plan_kept kept[PLAN_SHELF_LIMIT];
    uint64_t use_count;
    int64_t plan_count; // of plans that were numbered here
};

void plan_shelf_finish(struct plan_shelf *shelf);

struct plan_shelf_params {
    struct plan_params plan;          // its evidence is not used
    int64_t serial;                   // identifies the job
    const struct plan_source *source; // NULL: plans are made and numbered here
    void (*on_plan)(void *user);      // NULL, or called before a plan is made
    // NULL, or called after one was made, with the seconds that a frame's rendering is to take; 0: not known.
    void (*on_planned)(void *user, double render_s);
    void *user;
};

// The segment's newest plan, valid until the next call. NULL on failure, `fault` then being one of the renderer's.
struct plan_kept *plan_shelf_find(struct plan_shelf *shelf, const struct plan_shelf_params *params,
                                  enum renderer_fault *fault, struct error *error);
// Has the segment's next plan numbered, which replaces the kept one from the next call of plan_shelf_find on: the kept
// one missed the tolerance in `frame`, and `found` kept it. False as above.
bool plan_shelf_replace(struct plan_shelf *shelf, const struct plan_shelf_params *params, struct plan_kept *kept,
                        int32_t frame, const struct plan *found, enum renderer_fault *fault, struct error *error);
