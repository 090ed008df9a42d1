// Light of lamps in or near media, by connections over one vertex more that is drawn near the lamp.
// SPDX-License-Identifier: Apache-2.0
// Close to a lamp its light grows as 1 / r^2, and paths that come there by chance have an infinite variance. So a part
// of this light, path_peak_share, is left to connections whose new vertex is drawn together with the direction to it:
// Georgiev et al., Joint Importance Sampling of Low-Order Volumetric Scattering, SIGGRAPH Asia 2013. Along the camera's
// own ray it is drawn equiangularly: Kulla and Fajardo, Importance Sampling Techniques for Path Tracing in
// Participating Media, EGSR 2012.
#pragma once

#include "reference/path_light.h"

// Adds the light of one lamp, of one scattering more than the vertex', less what belongs to other ways to find it.
void path_peak_add_one(const struct path_scene *scene, const struct path_vertex *vertex, const struct path_aim *aim,
                       size_t lamp, struct stream *stream, double radiance[static 3]);
// The same of all lamps, from where a path begins. From a path's beginning the new vertex lies on its ray
// between `near` and `far`, which do not count elsewhere.
void path_peak_add(const struct path_scene *scene, const struct path_vertex *vertex, double near, double far,
                   struct stream *stream, double radiance[static 3]);
