// Extent of a scene's media along camera rays: what steps are measured by.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct job;
struct scene_inputs;

struct scene_extent {
    double near, far; // m from the camera, of media and of camera.clip both; far is INFINITY where media do not end
    double length;    // m: diameter of the smallest medium, at most far - near
    double voxel;     // m: the shortest edge of the finest grid; 0: there is none
};

// Finds the extent while the frame's shutter is open. `inputs` are the frame's. Where nothing has an end the length is
// 1.
struct scene_extent scene_extent_find(const struct job *job, const struct scene_inputs *inputs, int32_t frame);
