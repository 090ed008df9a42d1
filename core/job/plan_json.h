// A plan as JSON: the settings of a segment's frames, and what their audits share.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "core/job/job_beyond.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct json_node;
struct json_writer;

enum {
    PLAN_JSON_REASON_SIZE = 320,
    PLAN_JSON_SCOUT_LIMIT = 17,
    PLAN_JSON_VIEW_LIMIT = 3,
    PLAN_JSON_PIXEL_LIMIT = 4096,
    PLAN_JSON_SAMPLE_LIMIT = 256,
    PLAN_JSON_SAMPLE_NUMBERS = 3
};

struct plan_json {
    struct job_quality quality;         // of frames that are not refined; its method is stated
    char reason[PLAN_JSON_REASON_SIZE]; // why this one
    // The quality that this one replaced because one frame was over its tolerance: others may do with it.
    bool has_before;
    struct job_quality before;
    // The relative RMSE of that quality in frames that lie evenly over the segment, the first and the last among them.
    double scout_errors[PLAN_JSON_SCOUT_LIMIT];
    int scout_count;
    // Squared relative RMSE of a grid of scattered light: of its cells, and of its paths. Both 0: there is none.
    double cells_square, paths_square;
    // Small pictures of some frames show audits where a frame's error is: in this quality and in the plan's own.
    struct job_quality view_quality;
    int view_pixels; // of each picture, at most
    int32_t view_frames[PLAN_JSON_VIEW_LIMIT];
    int view_count;
    // Pixels of those frames that were measured, in `before` if there is one, else in the plan's quality: square, cross
    // and noise of each.
    double samples[PLAN_JSON_SAMPLE_LIMIT][PLAN_JSON_SAMPLE_NUMBERS];
    int sample_count;
    double sample_change;     // the largest change of these pictures by finer steps, a relative RMSE
    struct job_beyond beyond; // what the modelled orders of scattering leave out
};

// Reads a plan for `job`, whose quality is of method auto. What no plan chooses is the job's: its samples, tolerance,
// on_miss and max_cut. Each quality is read as a job's own; job_check says whether the scene suits it.
bool plan_from_json(struct plan_json *plan, const struct json_node *object, const struct job *job, struct error *error);
// Reads the quality alone, which is the key "quality" of the object.
bool plan_quality_from_json(struct job_quality *quality, const struct json_node *object, const struct job *job,
                            struct error *error);
// Writes one object. A number that is not finite becomes 1e300.
void plan_to_json(struct json_writer *writer, const struct plan_json *plan, const struct job *job);
