// SPDX-License-Identifier: Apache-2.0
#include "reference/light.h"

#include <math.h>

static struct light_arrival arrive(const struct light *light, struct vec3 travel, double distance, double factor)
{
    struct light_arrival arrival = {.travel = travel, .distance = distance};

    for (int c = 0; c < 3; c++)
        arrival.irradiance[c] = light->intensity[c] * factor;
    return arrival;
}

static struct light_arrival arrive_from_point(const struct light *light, struct vec3 position)
{
    struct vec3 from_light = vec3_subtract(position, light->position);
    double distance = vec3_length(from_light);
    double factor = light->falloff == SCENE_FALLOFF_INVERSE_SQUARE ? 1.0 / (distance * distance) : 1.0;

    // At the light itself no direction is better than another.
    return arrive(light, vec3_scale(from_light, distance > 0.0 ? 1.0 / distance : 0.0), distance, factor);
}

double light_spot_share(double inner, double outer, double angle)
{
    double share;

    if (angle <= inner) return 1.0;
    if (angle >= outer) return 0.0;
    share = (outer - angle) / (outer - inner);
    return share * share * (3.0 - 2.0 * share);
}

static struct light_arrival arrive_from_spot(const struct light *light, struct vec3 position)
{
    struct light_arrival arrival = arrive_from_point(light, position);
    double away = vec3_length(vec3_cross(light->direction, arrival.travel));
    double share =
        light_spot_share(light->inner, light->outer, atan2(away, vec3_dot(light->direction, arrival.travel)));

    for (int c = 0; c < 3; c++)
        arrival.irradiance[c] *= share;
    return arrival;
}

static struct light_arrival arrive_from_sun(const struct light *light)
{
    return arrive(light, light->direction, INFINITY, 1.0);
}

struct light_arrival light_arrive(const struct light *light, struct vec3 position)
{
    switch (light->kind) {
    case SCENE_LIGHT_POINT:
        return arrive_from_point(light, position);
    case SCENE_LIGHT_SPOT:
        return arrive_from_spot(light, position);
    case SCENE_LIGHT_SUN:
    case SCENE_LIGHT_SPHERE:
    case SCENE_LIGHT_DOME:
        break;
    }
    return arrive_from_sun(light);
}
