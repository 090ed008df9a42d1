// The probability density by which an audit draws pixels of a frame to see what its interpolated ones lack.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/audit/audit_estimate.h"
#include "worker/picture/pixel.h"

#include <stddef.h>
#include <stdint.h>

struct image;

// Strategies by which a pixel is drawn. Each has a share of the draws; those that a frame lacks give it to the first.
enum interpolation_strategy {
    INTERPOLATION_ANY,      // traced and interpolated pixels alike
    INTERPOLATION_ALIKE,    // interpolated pixels, each as likely
    INTERPOLATION_DOUBTFUL, // in proportion to the square of their doubt
    INTERPOLATION_COUNT
};

struct interpolation_map {
    const struct image *image; // borrowed; it has `doubts`
    enum job_pixel pixel;
    double mean_square;                // of the frame's values
    double share[INTERPOLATION_COUNT]; // of the draws
    double *sums[INTERPOLATION_COUNT]; // owned; running sums of the rows' weights; NULL for INTERPOLATION_ANY
};

// `pixel` is the encoding of the frame's values.
void interpolation_map_init(struct interpolation_map *map, const struct image *image, enum job_pixel pixel);
void interpolation_map_finish(struct interpolation_map *map);
// The probability that a draw is this pixel, times the number of pixels.
double interpolation_map_density(const struct interpolation_map *map, struct pixel point);
// Writes `count` draws for that frame of the job.
void interpolation_map_draw(const struct interpolation_map *map, const struct job *job, int32_t frame, size_t count,
                            struct pixel *points);
// The sample of a drawn pixel, `traced` being its R, G and B.
struct audit_sample interpolation_map_compare(const struct interpolation_map *map, struct pixel point,
                                              const float *traced);
