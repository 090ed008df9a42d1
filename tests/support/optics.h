// Reflection and refraction at smooth surfaces, in closed form.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/vec3.h"

#include <stdbool.h>

// The share of unpolarised light that a boundary reflects, from `ior_in` to `ior_out`, at the cosine `cos_in`; 1 beyond
// the critical angle. Computed from Fresnel's amplitudes and explicit angles.
double optics_fresnel(double cos_in, double ior_in, double ior_out);
// f0 + (f90 - f0) (1 - c)^5 with the cosine of the side with the smaller index; 1 beyond the critical angle.
double optics_schlick(double cos_in, double ior_in, double ior_out, double f0, double f90);
double optics_default_f0(double ior_in, double ior_out);

// `normal` may point to either side.
struct vec3 optics_reflect(struct vec3 direction, struct vec3 normal);
// False beyond the critical angle.
bool optics_refract(struct vec3 direction, struct vec3 normal, double ior_in, double ior_out, struct vec3 *refracted);

// The interval of a ray's line inside a ball; false where it misses the ball.
bool optics_meet_ball(const struct ray *ray, struct vec3 center, double radius, double *enter, double *leave);
// The distance to a plane; INFINITY where the ray does not meet it, or only before its origin.
double optics_meet_plane(const struct ray *ray, struct vec3 point, struct vec3 normal);
