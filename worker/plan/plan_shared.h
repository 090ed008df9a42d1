// Plans as workers share them: which segments share one, and what a plan follows from after it was sent.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "core/job/plan_json.h"
#include "worker/render/renderer_fault.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct job;
struct plan;
struct plan_evidence;
struct plan_params;

// Hashes what the plan of a segment depends on: the job, the numbers of its frames, the files that its pilot reads, and
// this version. Segments with equal keys have one plan.
void plan_shared_find_key(const struct plan_params *params, char key[static HASH_TEXT_SIZE]);

// Its qualities are such as `job` could state.
void plan_shared_describe(struct plan_json *shared, const struct plan *plan, const struct plan_evidence *evidence,
                          const struct job *job);
// The plan as every worker has it, the one that made it too. Evidence that is empty is rendered again; the same
// settings make the same pictures. On failure `fault` is one of the renderer's, or none where no plan of this version
// chooses such settings.
bool plan_shared_adopt(struct plan *plan, struct plan_evidence *evidence, const struct plan_json *shared,
                       const struct plan_params *params, enum renderer_fault *fault, struct error *error);

// The plan after a frame missed the tolerance, as plan_of_frame made it, and kept it with `found`. All frames are
// refined by as many rungs; with another family the errors at the scouts are not known. Nothing is pooled.
void plan_shared_replace(struct plan_json *shared, const struct plan *plan, int32_t frame, const struct plan *found,
                         const struct plan_evidence *evidence, const struct job *job);
