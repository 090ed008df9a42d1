// What a pixel of a frame should be, and how far an image is from that.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/integrate.h"
#include "reference/still.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct reference_pixel {
    double radiance[3];       // with the background, if there is one, behind everything
    double radiance_error[3]; // standard error of that as a mean of samples; 0 of fewer than two
    double transmittance[3];  // of light from behind everything that comes without a reflection
    double alpha;             // 1 - mean transmittance; 1 before a background
    // A sample's rays, the camera's own among them; those that were cut; the sum of these rays' mean throughputs; the part
    // of it that their depth alone cut.
    double ray_count, cut_count, cut_throughput, cut_by_depth;
    bool is_converged;
};

// Along the ray through the centre of pixel (x, y), counted from the top left; of rough surfaces it is one sample of many.
// `accuracy` may be NULL.
struct reference_pixel reference_measure_pixel(const struct still *still, int x, int y,
                                               const struct integrate_accuracy *accuracy);
// One camera ray of a pixel.
struct reference_sample {
    double x, y;   // in the pixel, from its top left corner: (0.5, 0.5) is its centre
    double time;   // s: the moment at which the scene is stopped
    uint64_t seed; // of the random numbers of rough surfaces, of which each sample needs its own
};

// The mean of `count` >= 1 samples of pixel (x, y). `inputs` and `accuracy` may be NULL.
struct reference_pixel reference_measure_samples(const struct job *job, const struct still_inputs *inputs, int x, int y,
                                                 const struct reference_sample *samples, size_t count,
                                                 const struct integrate_accuracy *accuracy);
// Camera-space depth in metres of the first surface, or where the mean transmittance of the pixel's ray passes 0.5 before
// it; 0 where neither is. From inside something opaque it is that of its far side.
double reference_measure_depth(const struct still *still, int x, int y);

struct reference_error {
    double relative_rmse; // sqrt(mean (I - R)^2) / sqrt(mean R^2); the numerator alone when all of R is below 1e-6
    double largest;       // |I - R| over all channels
    size_t largest_index; // of the value where it is
};

// `count` values of both, pixels times channels. A value that is not finite makes the error infinite.
struct reference_error reference_image_error(const float *image, const double *reference, size_t count);
