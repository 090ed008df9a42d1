// The rays of a frame: how many there were, how many were cut, and the share of light that the cut ones may have had.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct image;
struct job_quality;

// The pixel with the largest of some value.
struct ray_counts_peak {
    double value; // per sample
    int x_px, y_px;
};

// The zero value is for a scene without reflection and refraction. A ray's throughput is the mean over its colours. A
// cut ray is one that was not followed (struct job_quality).
struct ray_counts {
    bool is_known;
    double rays;                                // per pixel and sample, with the camera ray and without the cut ones
    double cut_rays;                            // per pixel and sample
    double cut_throughput;                      // per pixel and sample: the summed throughput of the cut rays
    double cut_by_depth;                        // the part that max_depth cut; min_throughput cut the rest
    double cut_share;                           // [0, 1]; see ray_counts_find_share
    struct ray_counts_peak most_rays, most_cut; // most_cut: summed throughput
};

// Adds a pixel's 4 numbers, summed over its samples: throughput cut, rays cut, rays followed, throughput cut by
// max_depth. The fields are sums until ray_counts_find_means.
void ray_counts_add_pixel(struct ray_counts *counts, const float paths[static 4], int x_px, int y_px);
// Adds a row of pixels.
void ray_counts_add_row(struct ray_counts *counts, const float *paths, int width_px, int y_px);
// Divides the sums by the numbers of pixels and samples. Called once.
void ray_counts_find_means(struct ray_counts *counts, int64_t pixel_count, int sample_count);

// Finds the share of the frame's light that the cut rays may have had. If each had brought the brightest value of the
// picture, they would have added cut_throughput * brightest to its mean. The share is a bound as long as none would
// have brought more. For a black picture it is the throughput itself. It is at most 1.
void ray_counts_find_share(struct ray_counts *counts, const struct image *image);

// Returns false when the share is larger than the job allows; `error` names the limit that cut the rays and what helps.
bool ray_counts_check(const struct ray_counts *counts, const struct job_quality *quality, struct error *error);
