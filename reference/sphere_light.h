// Lamps with size: spheres of even radiance outside and dark inside, which block nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/vec3.h"

struct sphere_light {
    struct vec3 center;
    double radius;      // m, > 0
    double radiance[3]; // W/(m^2 sr): its intensity from afar over pi radius^2
};

// m from the ray's origin to where it meets the lamp from outside; INFINITY: it passes by, or begins inside.
double sphere_light_distance(const struct sphere_light *lamp, const struct ray *ray);

// The solid angle that the lamp fills, seen from `position`: 2 pi (1 - cos of its half-angle); 0 inside.
double sphere_light_solid_angle(const struct sphere_light *lamp, struct vec3 position);

// A direction from `position`, outside of the lamp, towards it. With `u` even in [0, 1)^2 directions are even in the
// lamp's solid angle: their density is 1 over that. Shirley, Wang and Zimmerman, ACM Transactions on Graphics 15, 1996.
struct vec3 sphere_light_draw(const struct sphere_light *lamp, struct vec3 position, const double u[static 2]);
