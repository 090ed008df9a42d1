// How far the rays of frames go through media, by reference/'s geometry: no light is computed, and no file is read.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct job;

// Means in metres; 0 where no ray meets a medium.
struct truth_lengths {
    double camera; // of camera rays that meet a medium: straight on through dielectrics, up to what is opaque
    double light;  // of rays from there towards each light: through media whose density varies
};

// Follows the rays of 144 points of each frame. The job has no density of kind grid.
struct truth_lengths truth_lengths_find(const struct job *job, const int32_t *frames, int frame_count);
