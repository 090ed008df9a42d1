// From where places in a shader are told: the world's origin is far away for a float where the camera is.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct job;

// False where the camera stays near the origin throughout the job: the anchor is the origin, at any time.
bool scene_anchor_is_used(const struct job *job);
bool scene_anchor_moves(const struct job *job);
// A point near the camera. In whole numbers of a coarse step, so that it stays where it is while the camera moves a little,
// and is exact as a float.
void scene_anchor_find(const struct job *job, double time, double anchor[static 3]);
