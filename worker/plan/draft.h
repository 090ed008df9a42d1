// A draft's settings: the method and its numbers that a count of the work favours. Nothing is rendered for it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/picture/image_exr.h"

#include <stdbool.h>
#include <stddef.h>

struct error;

enum { DRAFT_FAMILY_LIMIT = 16 };

// A method that could render the job.
struct draft_option {
    const char *name;   // static
    double evaluations; // of densities, a pixel, with 64 steps along the longest path through media
};

struct draft {
    struct job_quality quality; // of the cheapest option; it says of itself that it is a draft
    double evaluations;         // of densities, a pixel, as plan_family_work counts them where all rays meet the media
    struct draft_option options[DRAFT_FAMILY_LIMIT]; // the cheapest first
    size_t option_count;
    char reason[IMAGE_EXR_PLAN_SIZE]; // one sentence for the file's header
};

// The evaluations of densities a pixel that a draft may take. Set by hand, so that the first 640x360 frame of each
// example takes less than a second on two cores with software GL: docs/measured.md.
extern const double DRAFT_EVALUATIONS;

// Chooses the settings for a job of any quality, with one sample a pixel. The job alone decides: equal jobs get equal
// drafts. False when no method that is counted serves the scene.
bool draft_choose(struct draft *draft, const struct job *job, struct error *error);
// Replaces the quality of a job of method draft by the chosen one; others stay as they are. The job keeps its hash.
bool draft_settle(struct job *job, char reason[IMAGE_EXR_PLAN_SIZE], struct error *error);
// Evaluations of densities a pixel, counted where all rays meet the media. The job's method is neither auto nor draft.
// 0: the work of its method is not counted (riemann, tracking).
double draft_count(const struct job *job);
