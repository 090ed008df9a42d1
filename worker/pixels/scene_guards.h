// Where a frame has features that a lattice of pixels may miss: lamps, outlines of solids, small or sharp media.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/pixels/pixel_guard.h"

#include <stddef.h>
#include <stdint.h>

struct job;
struct scene_inputs;

enum { SCENE_GUARD_MOMENTS = 8 };

struct scene_guards {
    struct pixel_guard *list; // owned
    size_t count, capacity;
};

// Finds up to SCENE_GUARD_MOMENTS times of a frame's samples, the first and the last among them. Returns how many.
int scene_guards_find_moments(const struct job *job, int32_t frame, double times[static SCENE_GUARD_MOMENTS]);

// Finds the guards of a frame at up to SCENE_GUARD_MOMENTS moments of its samples:
// - a point at each lamp with a position, around which light grows without bound;
// - the outline of each sphere, as seen by the camera, and the edges of each box, among solids and among bounds of
//   media that end sharply or whose picture is narrower than a few steps of the job's lattice.
// Planes and slabs have none: a straight line that passes between four points in a square leaves one of them.
// `inputs` are the frame's.
void scene_guards_init(struct scene_guards *guards, const struct job *job, const struct scene_inputs *inputs,
                       int32_t frame);
void scene_guards_finish(struct scene_guards *guards); // accepts empty ones
