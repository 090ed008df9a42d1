// Light from all directions, infinitely far away: even, a gradient, or an image in latitude and longitude.
// SPDX-License-Identifier: Apache-2.0
// struct scene_dome (core/scene/scene.h) says which direction is where in an image. Between the middles of its texels
// it is bilinear; it goes on over the left and right border, and the outermost rows reach to the poles.
#pragma once

#include "core/scene/scene.h"
#include "reference/vec3.h"

#include <stdbool.h>

// The zero value is black.
struct dome {
    enum scene_dome_kind kind;
    double along[3];   // radiance; of a gradient that along the axis; by what an image is multiplied
    double against[3]; // gradient: radiance against the axis
    struct vec3 axis;  // gradient, image: of length 1
    double angle;      // image: radians by which it is turned about the axis
    const float *rgb;  // image: borrowed; outlives us; linear, >= 0, 3 a texel, rows from the top
    int width, height; // of the image; 0: it is black
    bool is_visible;   // it is seen behind everything
};

// The radiance that comes from the direction `toward`, of length 1: light from there travels along -toward.
void dome_radiance(const struct dome *dome, struct vec3 toward, double radiance[static 3]);

// The direction turned by `angle` about the dome's axis.
struct vec3 dome_turn(const struct dome *dome, struct vec3 direction, double angle);
