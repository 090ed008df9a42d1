// SPDX-License-Identifier: Apache-2.0
#include "reference/sphere_light.h"

#include <math.h>

double sphere_light_distance(const struct sphere_light *lamp, const struct ray *ray)
{
    struct vec3 toward = vec3_subtract(lamp->center, ray->origin);
    double along = vec3_dot(toward, ray->direction);
    double beside = vec3_length(vec3_subtract(toward, vec3_scale(ray->direction, along)));

    if (vec3_length(toward) <= lamp->radius || along <= 0.0 || beside >= lamp->radius) return INFINITY;
    return along - sqrt((lamp->radius - beside) * (lamp->radius + beside));
}

// 1 less the cosine of the half-angle, without the difference of two numbers near 1; 0 inside.
static double find_cap(const struct sphere_light *lamp, double distance)
{
    double sine = lamp->radius / distance;

    return distance > lamp->radius ? sine * sine / (1.0 + sqrt((1.0 - sine) * (1.0 + sine))) : 0.0;
}

double sphere_light_solid_angle(const struct sphere_light *lamp, struct vec3 position)
{
    return 2.0 * M_PI * find_cap(lamp, vec3_length(vec3_subtract(lamp->center, position)));
}

struct vec3 sphere_light_draw(const struct sphere_light *lamp, struct vec3 position, const double u[static 2])
{
    struct vec3 toward = vec3_subtract(lamp->center, position), axis = vec3_normalize(toward);
    struct vec3 any = fabs(axis.x) < 0.5 ? (struct vec3){1.0, 0.0, 0.0} : (struct vec3){0.0, 1.0, 0.0};
    struct vec3 right = vec3_normalize(vec3_cross(any, axis)), up = vec3_cross(axis, right);
    double below = u[0] * find_cap(lamp, vec3_length(toward)); // 1 less the cosine
    double sine = sqrt(below * (2.0 - below)), turn = 2.0 * M_PI * u[1];
    struct vec3 side = vec3_add(vec3_scale(right, sine * cos(turn)), vec3_scale(up, sine * sin(turn)));

    return vec3_normalize(vec3_add(vec3_scale(axis, 1.0 - below), side));
}
