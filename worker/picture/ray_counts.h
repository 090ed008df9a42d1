// How many rays a frame took, how many were cut, and which share of its light that may have cost.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct image;
struct job_quality;

// The pixel that has the most of something.
struct ray_counts_peak {
    double value; // a sample
    int x_px, y_px;
};

// The zero value is of a scene whose rays are neither reflected nor refracted. A ray's throughput here is the mean of its
// colours'; a ray that is cut is one that was not followed (struct job_quality).
struct ray_counts {
    bool is_known;
    double rays;           // a pixel and sample, the camera's own among them and those that were cut not
    double cut_rays;       // a pixel and sample
    double cut_throughput; // a pixel and sample: the sum of the cut rays'
    double cut_by_depth;   // the part of it that max_depth cut; the rest was below min_throughput
    double cut_share;      // [0, 1]; see ray_counts_find_share
    struct ray_counts_peak most_rays, most_cut; // most_cut: of throughput
};

// Adds a row of pixels, each the sum of its samples: throughput cut in all, rays cut, rays followed, throughput cut by
// max_depth. The means come out wrong until ray_counts_find_means.
void ray_counts_add_row(struct ray_counts *counts, const float *paths, int width_px, int y_px);
// Divides what was added up; once.
void ray_counts_find_means(struct ray_counts *counts, int64_t pixel_count, int sample_count);

// The share of the frame's light that the cut rays may have taken: had each brought as much as the brightest value of the
// picture, they would have added cut_throughput * brightest to its mean. So it is a bound as long as none of them would have
// seen more than that. Of a black picture it is the throughput itself; 1 is the most.
void ray_counts_find_share(struct ray_counts *counts, const struct image *image);

// False when the share is larger than the job allows: `error` says which limit cut the rays, and what helps.
bool ray_counts_check(const struct ray_counts *counts, const struct job_quality *quality, struct error *error);
