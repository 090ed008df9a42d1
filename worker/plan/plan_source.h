// Where plans are kept and numbered: with whoever hands out the frames, so that all workers share them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/plan_json.h"

#include <stdint.h>

struct error;

enum plan_source_answer {
    PLAN_SOURCE_HAS,     // the plan is there, or numbered and kept
    PLAN_SOURCE_MAKE,    // there is none, and the caller alone is to make it
    PLAN_SOURCE_REFUSED, // the plan is not one for this job
    PLAN_SOURCE_STOPPED  // the frame is no longer wanted
};

// `key` names a segment's scene: 32 hexadecimal digits. The number of a plan is greater than those of earlier ones.
struct plan_source {
    // Finds the newest plan; waits while another worker makes it. Leaves `plan` alone where its number is `*number`.
    enum plan_source_answer (*find)(void *user, const char *key, int64_t *number, struct plan_json *plan,
                                    struct error *error);
    // Has a plan kept, which gets the next number. `missed`: the number of the plan that it replaces; 0: none.
    enum plan_source_answer (*keep)(void *user, const char *key, int64_t missed, const struct plan_json *plan,
                                    int64_t *number, struct error *error);
    void *user;
};
