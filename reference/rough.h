// Rough boundaries: each ray meets a normal of its own.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/vec3.h"

#include <stdint.h>

// Any start. Steele, Lea and Flood, Fast Splittable Pseudorandom Number Generators, OOPSLA 2014.
struct rough_random {
    uint64_t state;
};

// normal + roughness * a vector from the unit sphere, of length 1; drawn again until it faces the normal's side and the
// ray, 16 times at most, then the normal itself. A roughness of 0 draws nothing.
struct vec3 rough_normal(struct rough_random *random, struct vec3 normal, struct vec3 direction, double roughness);
// Mirrors the direction at the surface when it does not leave it on the normal's side (`side` 1) or the other (-1).
struct vec3 rough_keep_side(struct vec3 direction, struct vec3 normal, double side);
