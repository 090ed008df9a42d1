// The share of light that a smooth boundary reflects, and the direction of the refracted rest.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"
#include "reference/vec3.h"

#include <stdbool.h>

struct fresnel {
    enum scene_fresnel kind;
    double f0, f90; // of Schlick's formula
    bool has_f0;    // else f0 follows from the iors
};

// In all functions `cos_in` in [0, 1] is the cosine between the reversed ray and the normal, and `eta` > 0 the ior
// before the boundary relative to the one behind it. Beyond the critical angle all light is reflected.

// Cosine of the refracted ray; negative beyond the critical angle. Snell's law.
double fresnel_cos_out(double cos_in, double eta);
// Unpolarised light, the mean of both polarisations; 0 when eta is 1. Born and Wolf, Principles of Optics, 1999, 1.5.2.
double fresnel_exact(double cos_in, double eta);
// f0 + (f90 - f0) (1 - c)^5, c the cosine on the side of the smaller ior. Schlick, Computer Graphics Forum 13, 1994.
double fresnel_schlick(double f0, double f90, double cos_in, double eta);
// The share by the given kind; 0 for SCENE_FRESNEL_NONE.
double fresnel_share(const struct fresnel *fresnel, double cos_in, double ior_before, double ior_behind);
// The direction of the refracted ray, which is not totally reflected. `direction` and `normal` have length 1, and
// dot(direction, normal) = -cos_in.
struct vec3 fresnel_refract(struct vec3 direction, struct vec3 normal, double eta);
struct vec3 fresnel_reflect(struct vec3 direction, struct vec3 normal);
