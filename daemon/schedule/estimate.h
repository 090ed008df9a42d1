// Estimates of frame time and remaining time of a job, from its recent frames.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { ESTIMATE_RECENT = 63 };

// One per job. The zero value holds no durations.
struct estimate {
    float recent_s[ESTIMATE_RECENT]; // a ring buffer
    uint8_t count, next;
    bool is_current; // median_s is the median of these durations
    float median_s;
    // What a worker's time goes into; moving means, 0: unknown.
    float pace_s;          // between two answers of one worker, without plans
    float pace_weight;     // of the frames in between
    double carried;        // frames of weight 1 that are left over, for those that are done had less
    float plan_s;          // a plan
    float foretold_s;      // a frame, by its plan, until one is done
    int64_t planned_count; // frames of a segment, which one plan serves
    uint8_t pace_count, plan_count, skip_count;
    float skip_s;      // a skipped frame
    uint32_t skip_run; // frames that were skipped since one was rendered
};

void estimate_add(struct estimate *estimate, double seconds); // of one frame; ignored unless in [0, 1e9)
// Seconds that a worker took for a frame: rendering, audit and whatever else it did, but no plan. Ignored likewise.
// `weight`: the frame's work, relative to the mean of its segment's frames, as far as it was predicted; else 1.
void estimate_add_pace(struct estimate *estimate, double seconds, double weight);
// The same of a worker's first frame of the job or after a plan: files were opened and programs linked, which does not
// come again. It counts as at most `told_s`, what the worker says of its rendering, audit and file.
void estimate_add_first(struct estimate *estimate, double seconds, double told_s, double weight);
// Seconds that a worker planned for so many frames. Ignored likewise, and with 0 frames.
void estimate_add_plan(struct estimate *estimate, double seconds, int64_t frame_count);
// Seconds of a frame's rendering by its plan, which count until a frame is done. 0: not known. Ignored likewise.
void estimate_foretell(struct estimate *estimate, double seconds);
// Seconds until a frame was skipped, for its file is there: nothing is learnt about frames that are rendered.
void estimate_add_skip(struct estimate *estimate, double seconds);
void estimate_end_skips(struct estimate *estimate);     // a frame is being rendered
size_t estimate_count(const struct estimate *estimate); // number of durations, at most ESTIMATE_RECENT
double estimate_median_s(struct estimate *estimate);    // 0: no durations
// What users are told of a frame: the median and, before a frame is done, what its plan foretells. 0: unknown.
double estimate_each_s(struct estimate *estimate);
// Seconds until `workers` have done the last `left` (queued and running) of `total` frames, in order, with the plans of
// the segments that are not begun; negative when unknown. While one worker plans a segment, the others wait for it.
double estimate_eta_s(struct estimate *estimate, int64_t total, int64_t left, int workers);
