// A source of plans in a test: it keeps the newest one of a single segment.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/plan_json.h"
#include "worker/plan/plan_source.h"

#include <stdint.h>

// The zero value has no plan. A test that changes `plan` also changes `number`, by which a change is known.
struct plan_keeper {
    struct plan_json plan;
    int64_t number, replaced; // of the newest plan, and of the one before; 0: none
    int first_sample_count;   // of the first plan
};

struct plan_source plan_keeper_source(struct plan_keeper *keeper); // borrows the keeper
