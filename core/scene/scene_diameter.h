// How long a straight line may be inside the things of a scene, m: INFINITY where they have no end.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/timeline.h"

struct scene;
struct scene_density;
struct scene_object;
struct scene_shape;

double scene_diameter_of_shape(const struct scene_shape *shape, struct timeline_span span);
double scene_diameter_of_object(const struct scene *scene, const struct scene_object *object,
                                struct timeline_span span);
// Of what a density fills; of a grid: its bounds.
double scene_diameter_of_density(const struct scene_density *density, struct timeline_span span);
