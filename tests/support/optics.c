// SPDX-License-Identifier: Apache-2.0
#include "tests/support/optics.h"

double optics_fresnel(double cos_in, double ior_in, double ior_out)
{
    double in = acos(fmin(cos_in, 1.0)), sine = ior_in / ior_out * sin(in), out, across, along;

    if (sine >= 1.0) return 1.0;
    out = asin(sine);
    across = (ior_in * cos(in) - ior_out * cos(out)) / (ior_in * cos(in) + ior_out * cos(out));
    along = (ior_in * cos(out) - ior_out * cos(in)) / (ior_in * cos(out) + ior_out * cos(in));
    return 0.5 * (across * across + along * along);
}

double optics_default_f0(double ior_in, double ior_out)
{
    double ratio = (ior_in - ior_out) / (ior_in + ior_out);

    return ratio * ratio;
}

double optics_schlick(double cos_in, double ior_in, double ior_out, double f0, double f90)
{
    double sine = ior_in / ior_out * sqrt(fmax(0.0, 1.0 - cos_in * cos_in)), cosine = cos_in;

    if (sine >= 1.0) return 1.0;
    if (ior_in > ior_out) cosine = sqrt(1.0 - sine * sine);
    return f0 + (f90 - f0) * pow(1.0 - cosine, 5.0);
}

struct vec3 optics_reflect(struct vec3 direction, struct vec3 normal)
{
    return vec3_subtract(direction, vec3_scale(normal, 2.0 * vec3_dot(direction, normal)));
}

bool optics_refract(struct vec3 direction, struct vec3 normal, double ior_in, double ior_out, struct vec3 *refracted)
{
    double height = vec3_dot(direction, normal);
    struct vec3 along = vec3_scale(vec3_subtract(direction, vec3_scale(normal, height)), ior_in / ior_out);
    double rest = 1.0 - vec3_dot(along, along);

    if (rest <= 0.0) return false;
    *refracted = vec3_normalize(vec3_add(along, vec3_scale(normal, copysign(sqrt(rest), height))));
    return true;
}

bool optics_meet_ball(const struct ray *ray, struct vec3 center, double radius, double *enter, double *leave)
{
    struct vec3 offset = vec3_subtract(center, ray->origin);
    double middle = vec3_dot(offset, ray->direction);
    struct vec3 beside = vec3_subtract(offset, vec3_scale(ray->direction, middle));
    double square = radius * radius - vec3_dot(beside, beside);

    if (square <= 0.0) return false;
    *enter = middle - sqrt(square);
    *leave = middle + sqrt(square);
    return true;
}

double optics_meet_plane(const struct ray *ray, struct vec3 point, struct vec3 normal)
{
    double distance = vec3_dot(vec3_subtract(point, ray->origin), normal) / vec3_dot(ray->direction, normal);

    return distance > 0.0 ? distance : INFINITY;
}
