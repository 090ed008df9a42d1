// SPDX-License-Identifier: Apache-2.0
#include "reference/rough.h"

#include <math.h>

enum { DRAW_LIMIT = 16 };

// A random number in [0, 1).
static double next_number(struct rough_random *random)
{
    uint64_t z = random->state += 0x9e3779b97f4a7c15u;

    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return (double)(z >> 11) * 0x1p-53;
}

// A random point of the unit sphere: heights on a sphere are uniform. Archimedes, On the Sphere and Cylinder.
static struct vec3 next_on_sphere(struct rough_random *random)
{
    double height = 2.0 * next_number(random) - 1.0, angle = 2.0 * M_PI * next_number(random);
    double radius = sqrt(1.0 - height * height);

    return (struct vec3){radius * cos(angle), radius * sin(angle), height};
}

struct vec3 rough_normal(struct rough_random *random, struct vec3 normal, struct vec3 direction, double roughness)
{
    if (roughness == 0.0) return normal;
    for (int i = 0; i < DRAW_LIMIT; i++) {
        struct vec3 moved = vec3_add(normal, vec3_scale(next_on_sphere(random), roughness));

        if (vec3_dot(moved, normal) > 0.0 && vec3_dot(moved, direction) < 0.0) return vec3_normalize(moved);
    }
    return normal;
}

struct vec3 rough_keep_side(struct vec3 direction, struct vec3 normal, double side)
{
    double height = vec3_dot(direction, normal);

    return height * side > 0.0 ? direction : vec3_subtract(direction, vec3_scale(normal, 2.0 * height));
}
