// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene_diameter.h"

#include "core/scene/density_rules.h"
#include "core/scene/scene.h"

#include <math.h>

static double bounds_diameter(const struct scene_bounds *bounds, struct timeline_span span)
{
    double min[3], size[3];

    switch (bounds->kind) {
    case SCENE_BOUNDS_SPHERE:
        return 2.0 * timeline_find_largest(&bounds->radius, span);
    case SCENE_BOUNDS_BOX:
        timeline_find_bounds(&bounds->size, span, min, size);
        return hypot(hypot(size[0], size[1]), size[2]);
    case SCENE_BOUNDS_NONE:
    case SCENE_BOUNDS_SLAB:
        break;
    }
    return INFINITY;
}

double scene_diameter_of_shape(const struct scene_shape *shape, struct timeline_span span)
{
    double min[3], size[3];

    switch (shape->kind) {
    case SCENE_SHAPE_SPHERE:
        return 2.0 * timeline_find_largest(&shape->radius, span);
    case SCENE_SHAPE_BOX:
        timeline_find_bounds(&shape->size, span, min, size);
        return hypot(hypot(size[0], size[1]), size[2]);
    case SCENE_SHAPE_PLANE:
        break;
    }
    return INFINITY;
}

// A straight line leaves each convex shape once.
double scene_diameter_of_object(const struct scene *scene, const struct scene_object *object, struct timeline_span span)
{
    double sum = 0.0;

    for (size_t i = 0; i < object->shape_count; i++)
        sum += scene_diameter_of_shape(&scene->shapes[object->first_shape + i], span);
    return sum;
}

double scene_diameter_of_density(const struct scene_density *density, struct timeline_span span)
{
    const struct density_rules *rules = density_rules_of(density);
    double bounds = bounds_diameter(&density->bounds, span);

    return rules->find_diameter ? fmin(bounds, rules->find_diameter(density, span)) : bounds;
}
