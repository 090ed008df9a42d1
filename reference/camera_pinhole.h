// A pinhole camera: the ray of a point of the image.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/vec3.h"

#include <stdbool.h>

struct camera_pinhole {
    struct vec3 position;
    struct vec3 right, up, forward; // of length 1, at right angles
    double tan_half_fov;            // of the vertical field of view
    int width_px, height_px;
    bool mirror;
    double clip_near, clip_far; // m along the ray
};

struct camera_pinhole_params {
    struct vec3 position, target, up;
    double fov_deg; // vertical
    int width_px, height_px;
    bool mirror;
    double clip_near, clip_far;
};

void camera_pinhole_init(struct camera_pinhole *camera, const struct camera_pinhole_params *params);
// `x` and `y` in pixels from the left and the top edge: pixel (i, j) has its centre at (i + 0.5, j + 0.5).
struct ray camera_pinhole_ray(const struct camera_pinhole *camera, double x, double y);
