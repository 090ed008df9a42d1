// Rough boundaries: each ray meets a random normal.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/vec3.h"

#include <stdint.h>

// The state of a random sequence; any start is valid. Steele, Lea and Flood, Fast Splittable Pseudorandom Number
// Generators, OOPSLA 2014.
struct rough_random {
    uint64_t state;
};

// A random normal: normal + roughness * a random vector of length 1, normalised. It is drawn again until it faces the
// normal's side and the ray, at most 16 times; then it is the normal itself. A roughness of 0 draws no random numbers.
struct vec3 rough_normal(struct rough_random *random, struct vec3 normal, struct vec3 direction, double roughness);
// Mirrors the direction at the surface unless it leaves on the required side: the normal's (`side` 1) or the other
// (-1).
struct vec3 rough_keep_side(struct vec3 direction, struct vec3 normal, double side);
