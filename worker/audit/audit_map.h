// The probability density by which an audit draws pixels of a frame: from the frame itself and two small renders.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/audit/audit_estimate.h"
#include "worker/audit/truth.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct image;

struct audit_map_params {
    const struct image *image; // the frame; borrowed; outlives the map
    enum job_pixel pixel;      // the encoding of its values
    // Two renders of one size, no larger than the frame, in finer and coarser steps. Both NULL: there are none.
    // `is_own`: they show this very frame, else one near it; then draws prefer pixels that differ from the finer one.
    const struct image *finer, *coarser;
    bool is_own;
};

// Strategies by which a pixel is drawn. Each has a share of the draws; the shares of those that a map lacks go to the
// others.
enum audit_strategy {
    AUDIT_STRATEGY_UNIFORM,
    AUDIT_STRATEGY_BRIGHT,  // in proportion to the square of the frame's values
    AUDIT_STRATEGY_SPIKE,   // to the squared distance of a pixel's values from the range of the four two pixels away
    AUDIT_STRATEGY_CUT,     // to the square of the throughput of the pixel's cut rays, if the image has it
    AUDIT_STRATEGY_HALVING, // to the squared difference of the two renders
    AUDIT_STRATEGY_ODD,     // to the squared distance of a block's mean from the finer render's values around it
    AUDIT_STRATEGY_COUNT
};

struct audit_map {
    const struct image *image; // borrowed
    enum job_pixel pixel;
    float brightest;    // the largest of the frame's values
    double mean_square; // of the frame's values; INFINITY where some value cannot be encoded
    double change;      // RMS of the two renders' difference, relative to the RMS of the finer one; negative: not known
    double share[AUDIT_STRATEGY_COUNT];
    // Owned; running sums: of rows for BRIGHT, SPIKE and CUT, of blocks for HALVING and ODD. NULL for strategies it
    // lacks.
    double *sums[AUDIT_STRATEGY_COUNT];
    int columns_count, rows_count; // of blocks: a block has the pixels that one pixel of the small renders shows
};

void audit_map_init(struct audit_map *map, const struct audit_map_params *params);
void audit_map_finish(struct audit_map *map); // accepts an empty one

// The floor of the accuracy asked of reference/ (reference/integrate.h) for a picture of that RMS: a tenth of the RMS.
// Darker pixels are measured as if they were so bright.
double audit_map_floor(double rms);
// True when all values are below AUDIT_BLACK: errors are absolute then.
bool audit_map_is_black(const struct audit_map *map);
// The probability that a draw is this pixel, times the number of pixels; at least the share of AUDIT_STRATEGY_UNIFORM.
double audit_map_density(const struct audit_map *map, struct pixel point);
// Writes draws number `first` to `first` + `count` - 1 of that frame of the job. They depend on the map, the job and
// the frame alone.
void audit_map_draw(const struct audit_map *map, const struct job *job, int32_t frame, size_t first, size_t count,
                    struct pixel *points);
// The sample of a drawn pixel; `pixel` is the reference's light in it. `traced`: its R, G and B, where the frame has it
// interpolated; NULL: those of the frame.
struct audit_sample audit_map_compare(const struct audit_map *map, struct pixel point, const float *traced,
                                      const struct truth_pixel *pixel);
