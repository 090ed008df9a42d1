// A plan: the method and its numbers that keep a tolerance, for one segment of an animation.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "core/job/job_beyond.h"
#include "worker/picture/image_exr.h"
#include "worker/plan/plan_scouting.h"
#include "worker/plan/plan_search.h"
#include "worker/plan/plan_segment.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PLAN_REASON_SIZE = IMAGE_EXR_PLAN_SIZE };

struct plan {
    struct job_quality quality; // its method is never auto; the number of samples is the job's own
    struct job_pixels pixels;   // which are traced; `quality` has none
    double predicted_traced;    // share of the pixels that are
    // Predictions for a frame at the job's resolution on this worker, in seconds; 0: not known.
    double predicted_s;                           // rendering alone
    double predicted_processor_s;                 // the same, summed over processors; 0 where a GPU renders
    double predicted_audit_s, predicted_encode_s; // audit; writing and reading back the file
    double predicted_frame_s;                     // all together
    double plan_s;                                // seconds that making the plan took, without timing
    double predicted_error;                       // relative RMSE: the quadratic mean over the segment's frames
    char reason[PLAN_REASON_SIZE];                // one sentence: why this plan and no other
    double work;                                  // evaluations of density per pixel, as plan_family_work counts them
    double making_work;                           // of making the plan, linking its programs included
    struct job_beyond beyond;                     // what the modelled orders of scattering leave out
    double work_ratio;             // mean work of the segment's frames, some of which are refined, relative to `work`
    struct plan_scouting scouting; // which frames are refined
    size_t family;                 // index in plan_families
    struct plan_point point;       // in that family
    // Squared relative RMSE of a grid of scattered light: of its cells, and of its paths. Both 0: not known.
    double cells_square, paths_square;
    // The quality, with its pixels, that this plan replaced because one frame was over its tolerance (plan_return.h).
    bool has_before;
    struct job_quality before;
};

// Refines every axis by `rungs`; two rungs halve a step. False when no axis can be refined.
bool plan_refine(struct plan *plan, const struct job *job, int rungs);
// The plan for one frame of the segment: refined where the scouting predicts an error over the tolerance.
struct plan plan_of_frame(const struct plan *plan, const struct job *job, int32_t frame);
// The counted work of a frame of the segment, relative to the mean of the segment's frames.
double plan_frame_weight(const struct plan *plan, const struct job *job, const struct plan_segment *segment,
                         int32_t frame);
// A shallow copy of the job with the plan's quality and pixels; never finished.
struct job plan_apply(const struct plan *plan, const struct job *job);
