// SPDX-License-Identifier: Apache-2.0
#include "reference/fresnel.h"

#include <math.h>

double fresnel_cos_out(double cos_in, double eta)
{
    double square = 1.0 - eta * eta * (1.0 - cos_in * cos_in);

    return square < 0.0 ? -1.0 : sqrt(square);
}

double fresnel_exact(double cos_in, double eta)
{
    double cos_out = fresnel_cos_out(cos_in, eta);
    double across, along;

    if (eta == 1.0) return 0.0;
    if (cos_out < 0.0) return 1.0;
    across = (eta * cos_in - cos_out) / (eta * cos_in + cos_out);
    along = (cos_in - eta * cos_out) / (cos_in + eta * cos_out);
    return 0.5 * (across * across + along * along);
}

double fresnel_schlick(double f0, double f90, double cos_in, double eta)
{
    double cos_out = fresnel_cos_out(cos_in, eta);

    if (cos_out < 0.0) return 1.0;
    return f0 + (f90 - f0) * pow(1.0 - (eta > 1.0 ? cos_out : cos_in), 5.0);
}

double fresnel_share(const struct fresnel *fresnel, double cos_in, double ior_before, double ior_behind)
{
    double eta = ior_before / ior_behind, normal = (ior_before - ior_behind) / (ior_before + ior_behind);

    switch (fresnel->kind) {
    case SCENE_FRESNEL_EXACT:
        return fresnel_exact(cos_in, eta);
    case SCENE_FRESNEL_SCHLICK:
        return fresnel_schlick(fresnel->has_f0 ? fresnel->f0 : normal * normal, fresnel->f90, cos_in, eta);
    case SCENE_FRESNEL_NONE:
        break;
    }
    return fresnel_cos_out(cos_in, eta) < 0.0 ? 1.0 : 0.0;
}

struct vec3 fresnel_refract(struct vec3 direction, struct vec3 normal, double eta)
{
    double cos_in = -vec3_dot(direction, normal);
    // The part along the boundary is scaled by eta; what is missing to length 1 goes against the normal.
    struct vec3 along = vec3_scale(vec3_add(direction, vec3_scale(normal, cos_in)), eta);
    double rest = fmax(1.0 - vec3_dot(along, along), 0.0);

    return vec3_normalize(vec3_subtract(along, vec3_scale(normal, sqrt(rest))));
}

struct vec3 fresnel_reflect(struct vec3 direction, struct vec3 normal)
{
    return vec3_subtract(direction, vec3_scale(normal, 2.0 * vec3_dot(direction, normal)));
}
