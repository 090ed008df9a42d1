// A camera at one moment, as rays and as matrices.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct scene_camera;

struct camera_view {
    double position[3];
    double right[3], up[3], forward[3]; // unit vectors; right is the image's, so `mirror` reverses it
    double half_height;                 // of the image one metre ahead, m
    double half_width;
};

// Where `up` is parallel to the view, some perpendicular direction replaces it.
bool camera_view_init(struct camera_view *view, const struct scene_camera *camera, double time, int width_px,
                      int height_px, struct error *error);

// Computes the OpenEXR attributes worldToCamera and worldToNDC: row vectors (p' = p M), row-major; camera space x
// right, y up, z forward; NDC (0, 0) at the upper left and (1, 1) at the lower right corner of the image after division
// by w. NDC z, which OpenEXR leaves open, is 1 - 1 m / z, so that the matrix has an inverse.
void camera_view_matrices(const struct camera_view *view, double world_to_camera[static 16],
                          double world_to_ndc[static 16]);
