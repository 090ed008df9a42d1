// When frames go back to the settings that a plan had before a harder frame.
// SPDX-License-Identifier: Apache-2.0
//
// A lamp that grazes something makes some frames of a segment harder than others. What these need is many times dearer,
// so each PLAN_RETURN_PACE-th frame tries the settings before first. Whether it does follows from its number alone.
#pragma once

#include "worker/plan/plan.h"

#include <stdbool.h>
#include <stdint.h>

struct audit_result;

enum { PLAN_RETURN_PACE = 4 };

// False where `plan` replaced none, in frames that try nothing, and in scenes in which nothing moves: what one frame
// needs, all do. Else `before` has the settings before.
bool plan_return_find(const struct plan *plan, const struct job *job, int32_t frame, struct plan *before);
// Whether an audit of such a frame has later ones return as well: its error and a standard error are within 0.8 of the
// tolerance.
bool plan_return_holds(const struct audit_result *audit);
// Notes in `found`, which replaces `missed`, what frames may return to: what `missed` itself may, or else `missed`.
void plan_return_note(struct plan *found, const struct plan *missed);
