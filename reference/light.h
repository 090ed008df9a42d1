// Lights without size: the direction of their light and its irradiance where nothing attenuates it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"
#include "reference/vec3.h"

struct light {
    enum scene_light_kind kind; // point, sun or spot
    enum scene_falloff falloff; // point only
    double intensity[3];        // W/sr, or W/m^2 without falloff and of a sun
    struct vec3 position;       // where its kind has one (core/scene/light_rules.h)
    struct vec3 direction;      // the same: the direction in which its light travels, of length 1
    double inner, outer;        // spot: half-angles in radians, inner <= outer
};

struct light_arrival {
    struct vec3 travel;   // direction in which the light passes the point
    double distance;      // m to the light; INFINITY for parallel light
    double irradiance[3]; // W/m^2
};

struct light_arrival light_arrive(const struct light *light, struct vec3 position);

// The share of a spot's intensity at `angle` (radians) from its direction: 1 up to `inner`, 0 from `outer` on,
// smoothstep between.
double light_spot_share(double inner, double outer, double angle);
