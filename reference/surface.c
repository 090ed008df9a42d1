// SPDX-License-Identifier: Apache-2.0
#include "reference/surface.h"

void surface_find_albedo(const struct objects *objects, size_t region, size_t shape, struct vec3 position,
                         double albedo[static 3])
{
    const struct object *object = &objects->list[region - 1];
    const struct texture *texture = &object->material.texture;
    bool is_own = shape - object->first_shape < object->shape_count;
    const struct shape *covered = &objects->shapes[is_own ? shape : object->first_shape];
    double color[3] = {1.0, 1.0, 1.0};

    if (texture->rgb) texture_sample(texture, texture_find(texture, covered, position), color);
    for (int c = 0; c < 3; c++)
        albedo[c] = object->material.albedo[c] * color[c];
}
