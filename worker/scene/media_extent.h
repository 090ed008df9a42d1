// Extents of media at a moment: along a direction, between distances, under angles.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct job;
struct scene_density;
struct scene_inputs;

// A region that holds all of a medium's density: the intersection of a ball and a box.
struct media_extent {
    bool has_ball, has_box;
    double center[3], radius; // of the ball, m
    double low[3], high[3];   // of the box, m
};

struct scene_ball {
    double center[3];
    double radius; // m; INFINITY: nothing is known
};

// Finds a medium's extent. `inputs` are the frame's; NULL where the job reads no files.
struct media_extent media_extent_of(const struct job *job, const struct scene_inputs *inputs, size_t medium,
                                    double time);
// Finds a ball that holds all of a medium's density.
struct scene_ball media_extent_ball(const struct job *job, const struct scene_inputs *inputs, size_t medium,
                                    double time);
// True when the extent is the same at all times; never of a grid, whose file may change.
bool media_extent_is_still(const struct scene_density *density);
// Returns the largest dot(p, direction) over the extent, its support function; `direction` is a unit vector.
double media_extent_support(const struct media_extent *extent, const double direction[static 3]);
// Finds bounds: no point of the extent is nearer to `from` than `near` or farther than `far`.
void media_extent_distances(const struct media_extent *extent, const double from[static 3], double *near, double *far);
// Returns the largest dot(p - from, across) / dot(p - from, along) over the extent; INFINITY where some point is not
// ahead. Both vectors are unit vectors at right angles.
double media_extent_tangent(const struct media_extent *extent, const double from[static 3],
                            const double across[static 3], const double along[static 3]);
