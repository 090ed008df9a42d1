// Where in its pixel and when each of a frame's samples looks: from job, frame, pixel and sample alone.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct job;

// Passes that a frame of the job takes: one a sample.
int pixel_samples_count(const struct job *job);
// The grid of strata in a pixel: columns x rows = count, as square as may be, columns >= rows.
void pixel_samples_strata(int count, int *columns, int *rows);
// What frames of different random numbers differ by; 0 for all frames of a job that never changes, so that they are equal.
uint32_t pixel_samples_frame_seed(const struct job *job, int32_t frame);
// Samples divide the time that the shutter is open: each sees the middle of its part. s.
double pixel_samples_time(const struct job *job, int32_t frame, int index);
// The middle of the time that the shutter is open, s.
double pixel_samples_middle(const struct job *job, int32_t frame);

struct pixel_point {
    float x_px, y_px; // from the image's top left
};

// The same bits as the point of shaders/camera/pixel_samples.glsl; the centre where there is but one sample.
struct pixel_point pixel_samples_point(const struct job *job, int32_t frame, int x, int y, int index);
