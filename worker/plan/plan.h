// What a tolerance comes down to: the method and its numbers for a stretch of an animation.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/picture/image_exr.h"
#include "worker/plan/plan_scouting.h"
#include "worker/plan/plan_search.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PLAN_REASON_SIZE = IMAGE_EXR_PLAN_SIZE };

struct plan {
    struct job_quality
        quality;        // of a method that renders, never auto; what the job itself says of samples and paths is in it
    double predicted_s; // a frame at the job's resolution, rendering alone, on this worker; 0: not known
    double predicted_processor_s;                 // the same of all processors together; 0: not known, or a GPU renders
    double predicted_audit_s, predicted_encode_s; // of a frame; 0: not known
    double predicted_frame_s;                     // altogether
    double plan_s;                                // that the plan took, timing apart
    double predicted_error;                       // relative RMSE, the quadratic mean of the segment's frames
    char reason[PLAN_REASON_SIZE];                // one sentence: why this and no other
    double work;                                  // evaluations of density a pixel, as plan_family_work counts them
    double work_ratio; // work of all the segment's frames, of which some are rendered finer, beside that of `quality`
    struct plan_scouting scouting; // which frames these are
    size_t family;                 // of plan_families
    struct plan_point point;
};

// Every axis `rungs` finer, two halving a step; false when there is nothing finer.
bool plan_refine(struct plan *plan, const struct job *job, int rungs);
// The plan for a frame of the segment: finer, if the plan is expected to be over the tolerance in it.
struct plan plan_of_frame(const struct plan *plan, const struct job *job, int32_t frame);
// A job's shallow copy as the plan has it rendered; never finished.
struct job plan_apply(const struct plan *plan, const struct job *job);
