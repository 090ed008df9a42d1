// Vectors of three doubles.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <math.h>

struct vec3 {
    double x, y, z;
};

static inline struct vec3 vec3_from(const double value[static 3])
{
    return (struct vec3){value[0], value[1], value[2]};
}

static inline struct vec3 vec3_add(struct vec3 a, struct vec3 b)
{
    return (struct vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline struct vec3 vec3_subtract(struct vec3 a, struct vec3 b)
{
    return (struct vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline struct vec3 vec3_scale(struct vec3 a, double factor)
{
    return (struct vec3){a.x * factor, a.y * factor, a.z * factor};
}

static inline double vec3_dot(struct vec3 a, struct vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct vec3 vec3_cross(struct vec3 a, struct vec3 b)
{
    return (struct vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double vec3_length(struct vec3 a)
{
    return sqrt(vec3_dot(a, a));
}

static inline struct vec3 vec3_normalize(struct vec3 a) // of any length but 0
{
    return vec3_scale(a, 1.0 / vec3_length(a));
}

struct ray {
    struct vec3 origin;
    struct vec3 direction; // of length 1: distances along the ray are metres
};

static inline struct vec3 ray_at(const struct ray *ray, double distance)
{
    return vec3_add(ray->origin, vec3_scale(ray->direction, distance));
}
