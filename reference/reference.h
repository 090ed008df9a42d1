// The light that a pixel of a frame should show, and the error of an image against it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/integrate.h"
#include "reference/still.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct reference_pixel {
    double radiance[3];       // with the background, if there is one, behind everything
    double radiance_error[3]; // its standard error as a mean of samples; 0 for fewer than two
    double transmittance[3];  // of light from behind everything, without reflections
    double alpha;             // 1 - mean transmittance; 1 with a background
    // Per sample: rays, the camera's own included; cut rays; the sum of the cut rays' mean throughputs; the part
    // of that sum that was cut by depth.
    double ray_count, cut_count, cut_throughput, cut_by_depth;
    bool is_converged;
};

// The light along the ray through the centre of pixel (x, y), counted from the top left. With rough surfaces it is one
// random sample. `accuracy` may be NULL.
struct reference_pixel reference_measure_pixel(const struct still *still, int x, int y,
                                               const struct integrate_accuracy *accuracy);
// One camera ray of a pixel.
struct reference_sample {
    double x, y;   // in the pixel, from its top left corner: (0.5, 0.5) is its centre
    double time;   // in seconds: the moment of the scene
    uint64_t seed; // of the random numbers of rough surfaces; each sample needs its own
};

// The mean of `count` >= 1 samples of pixel (x, y). `inputs` and `accuracy` may be NULL.
struct reference_pixel reference_measure_samples(const struct job *job, const struct still_inputs *inputs, int x, int y,
                                                 const struct reference_sample *samples, size_t count,
                                                 const struct integrate_accuracy *accuracy);
// Camera-space depth in metres of the first surface, or of the point before it where the mean transmittance of the
// pixel's ray falls below 0.5; 0 where there is neither. From inside an opaque object it is the depth of the object's
// far side.
double reference_measure_depth(const struct still *still, int x, int y);

struct reference_error {
    double relative_rmse; // sqrt(mean (I - R)^2) / sqrt(mean R^2); the numerator alone when all of R is below 1e-6
    double largest;       // |I - R| over all channels
    size_t largest_index; // of the value that has it
};

// Compares `count` values, pixels times channels. A value that is not finite makes the error infinite.
struct reference_error reference_image_error(const float *image, const double *reference, size_t count);
