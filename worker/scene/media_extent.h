// Where media are at a moment, seen from somewhere: how far along a direction, between which distances, at which angles.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct job;
struct scene_density;
struct scene_inputs;

// A region that holds all of a medium's density: what a ball and a box have in common.
struct media_extent {
    bool has_ball, has_box;
    double center[3], radius; // of the ball, m
    double low[3], high[3];   // of the box, m
};

struct scene_ball {
    double center[3];
    double radius; // m; INFINITY: nothing is known
};

// `inputs` are the frame's; NULL where the job reads no files.
struct media_extent media_extent_of(const struct job *job, const struct scene_inputs *inputs, size_t medium,
                                    double time);
// A ball that holds all of a medium's density at a time.
struct scene_ball media_extent_ball(const struct job *job, const struct scene_inputs *inputs, size_t medium,
                                    double time);
// True when it is the same at all times; of a grid never, as its file may change.
bool media_extent_is_still(const struct scene_density *density);
// The largest dot(p, direction) of its points; `direction` is a unit vector.
double media_extent_support(const struct media_extent *extent, const double direction[static 3]);
// No point of it is nearer to `from` than `near` or farther than `far`.
void media_extent_distances(const struct media_extent *extent, const double from[static 3], double *near, double *far);
// The largest dot(p - from, across) / dot(p - from, along) of its points; INFINITY where some point is not ahead. The two
// are unit vectors at right angles.
double media_extent_tangent(const struct media_extent *extent, const double from[static 3],
                            const double across[static 3], const double along[static 3]);
