// The anchor, the point that positions in a shader are relative to: floats are too coarse far from the world's origin.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct job;

// Returns false where the camera stays near the origin throughout the job: the anchor is the origin, at any time.
bool scene_anchor_is_used(const struct job *job);
bool scene_anchor_moves(const struct job *job);
// Finds a point near the camera whose coordinates are whole multiples of a coarse step. It stays while the camera moves
// a little, and is exact as a float.
void scene_anchor_find(const struct job *job, double time, double anchor[static 3]);
