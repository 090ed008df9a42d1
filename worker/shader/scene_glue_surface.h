// Writes the part of a scene's shader that asks its objects: where a ray meets them, and their material there.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct scene_model;

// What ray modules call; objects and regions are numbered from 1, region 0 being air:
//   ShapeSpans                  distances between which a ray is inside each shape
//   shape_spans(origin, direction)
//   shape_normal(shape, p)      outward unit normal
//   surface_around(spans)       the objects that contain the ray's origin, a bit each
//   surface_next(spans, from, inside, left)   the nearest boundary beyond `from`
//   surface_is_opaque(region)
// and where some object reflects or refracts:
//   surface_ior(region)
//   surface_fresnel(object, cos_in, eta)   the share that is reflected
//   surface_roughness(object)
void scene_glue_write_surfaces(FILE *out, const struct scene_model *model);
