// Points and times of a frame's samples, which follow from job, frame, pixel and sample only.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct job;

// Returns the number of passes of a frame: one a sample.
int pixel_samples_count(const struct job *job);
// Finds the grid of strata in a pixel: columns x rows = count, as square as possible, columns >= rows.
void pixel_samples_strata(int count, int *columns, int *rows);
// Returns the seed of a frame's random numbers; 0 for all frames of a job that never changes, so that they are equal.
uint32_t pixel_samples_frame_seed(const struct job *job, int32_t frame);
// Returns a sample's time, s: samples divide the time that the shutter is open, and each has the middle of its part.
double pixel_samples_time(const struct job *job, int32_t frame, int index);
// Returns the middle of the time that the shutter is open, s.
double pixel_samples_middle(const struct job *job, int32_t frame);

struct pixel_point {
    float x_px, y_px; // from the image's top left
};

// Finds a sample's point, to the bit that of shaders/camera/pixel_samples.glsl; the centre where there is one sample.
struct pixel_point pixel_samples_point(const struct job *job, int32_t frame, int x, int y, int index);
