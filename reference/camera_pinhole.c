// SPDX-License-Identifier: Apache-2.0
#include "reference/camera_pinhole.h"

#include <math.h>

void camera_pinhole_init(struct camera_pinhole *camera, const struct camera_pinhole_params *params)
{
    struct vec3 forward = vec3_normalize(vec3_subtract(params->target, params->position));
    struct vec3 right = vec3_normalize(vec3_cross(forward, params->up));

    *camera = (struct camera_pinhole){
        .position = params->position,
        .right = right,
        .up = vec3_cross(right, forward),
        .forward = forward,
        .tan_half_fov = tan(params->fov_deg * M_PI / 360.0),
        .width_px = params->width_px,
        .height_px = params->height_px,
        .mirror = params->mirror,
        .clip_near = params->clip_near,
        .clip_far = params->clip_far,
    };
}

struct ray camera_pinhole_ray(const struct camera_pinhole *camera, double x, double y)
{
    // Pixels are square: both axes are measured in half heights.
    double per_px = 2.0 * camera->tan_half_fov / camera->height_px;
    double across = (x - 0.5 * camera->width_px) * per_px * (camera->mirror ? -1.0 : 1.0);
    double upwards = (0.5 * camera->height_px - y) * per_px;
    struct vec3 offset = vec3_add(vec3_scale(camera->right, across), vec3_scale(camera->up, upwards));

    return (struct ray){camera->position, vec3_normalize(vec3_add(camera->forward, offset))};
}
