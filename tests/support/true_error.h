// A frame's error by the measure of a tolerance, from every pixel, or from 4096 at random of a larger one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct image;
struct job;

// The relative RMSE of the values as the job's files have them against the light along the same camera rays. `job` has
// the size and the samples that `image` was rendered with. A failure fails the test.
double true_error_measure(const struct job *job, int32_t frame, const struct image *image);
