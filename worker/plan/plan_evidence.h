// The evidence that a plan's trials on lattices of frames leave for the audits of the segment's frames.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/audit/audit.h"
#include "worker/picture/image.h"
#include "worker/plan/plan_segment.h"

#include <stdint.h>

// The zero value is empty.
struct plan_evidence {
    struct audit_pool pool; // samples from the lattices; empty where reference/ has measured none
    struct plan_view {
        int32_t frame;
        struct image finer, coarser; // `coarser` in the plan's own steps, `finer` in steps at most half as long
    } views[PLAN_PILOT_LIMIT];
    int view_count;
    struct job_quality finest; // of every view's `finer`
    int pixel_limit;           // of their lattice: plan_lattice.h
};

void plan_evidence_finish(struct plan_evidence *evidence); // leaves it empty
// The view of the frame whose number is nearest; NULL when there are none.
const struct plan_view *plan_evidence_find(const struct plan_evidence *evidence, int32_t frame);
