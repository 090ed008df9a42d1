// Where a frame is looked at when it is audited: each pixel's probability, from the frame itself and two small renders.
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
    enum job_pixel pixel;      // as which its values are encoded
    // Two renders of one size, at most the frame's, that show the frame, or one near it, in finer and coarser steps. Both
    // NULL: there are none. `is_own`: they show this very frame, so where it differs from the finer one is looked at more.
    const struct image *finer, *coarser;
    bool is_own;
};

// Ways to draw a pixel. Each has a share of the draws; what a map lacks is shared out among the others.
enum audit_strategy {
    AUDIT_STRATEGY_UNIFORM,
    AUDIT_STRATEGY_BRIGHT,  // by the square of the frame's values
    AUDIT_STRATEGY_SPIKE,   // by how far a pixel is from all values two pixels beside, above and below it, squared
    AUDIT_STRATEGY_HALVING, // by the squared difference of the two renders
    AUDIT_STRATEGY_ODD,     // by how far the frame is from all values that the finer render has around a point, squared
    AUDIT_STRATEGY_COUNT
};

struct audit_map {
    const struct image *image; // borrowed
    enum job_pixel pixel;
    float brightest;    // of the frame's values
    double mean_square; // of the frame's values as encoded
    double change;      // RMS of the two renders' difference, relative to that of the finer one; negative: not known
    double share[AUDIT_STRATEGY_COUNT];
    double *sums
        [AUDIT_STRATEGY_COUNT]; // owned; running sums: of rows by brightness, of blocks by renders; NULL: no such draws
    int columns_count, rows_count; // blocks: a block is what a pixel of the small renders shows
};

void audit_map_init(struct audit_map *map, const struct audit_map_params *params);
void audit_map_finish(struct audit_map *map); // accepts an empty one

// True when all that is to be seen is below 1e-6: errors are absolute then.
bool audit_map_is_black(const struct audit_map *map);
// The probability that a draw is this pixel, times the number of pixels; at least the share of AUDIT_STRATEGY_UNIFORM.
double audit_map_density(const struct audit_map *map, struct truth_point point);
// Draws number `first` to `first` + `count` - 1 of frame `frame` of the job; the same whenever they are asked for, if the map is.
void audit_map_draw(const struct audit_map *map, const struct job *job, int32_t frame, size_t first, size_t count,
                    struct truth_point *points);
// What a drawn pixel says, whose true light is `pixel`.
struct audit_sample audit_map_compare(const struct audit_map *map, struct truth_point point,
                                      const struct truth_pixel *pixel);
