// SPDX-License-Identifier: Apache-2.0
#include "reference/light_walk.h"

#include "reference/transmittance.h"

#include <math.h>

// The transmitted share at the end of a piece, between air and dielectrics. Light is taken to come from the side of the
// smaller ior.
static double passed_share(const struct still *still, const struct ray *ray, const struct object_piece *piece,
                           size_t next_region)
{
    const struct objects *objects = &still->objects;
    size_t later = piece->region > next_region ? piece->region : next_region;
    double before = objects_ior(objects, piece->region), behind = objects_ior(objects, next_region);
    struct vec3 normal = shape_normal(&objects->shapes[piece->shape], ray_at(ray, piece->end));
    double cosine = fmin(fabs(vec3_dot(ray->direction, normal)), 1.0);

    return 1.0 - fresnel_share(&objects->list[later - 1].material.fresnel, cosine, fmin(before, behind),
                               fmax(before, behind));
}

void light_walk(const struct still *still, const struct ray *ray, double distance,
                const struct transmittance_accuracy *accuracy, double share[static 3])
{
    struct object_walk walk;

    objects_walk(&still->objects, ray, distance, &walk);
    for (int c = 0; c < 3; c++)
        share[c] = 1.0;
    for (size_t i = 0; i < walk.count; i++) {
        if (!objects_is_opaque(&still->objects, walk.pieces[i].region)) continue;
        for (int c = 0; c < 3; c++)
            share[c] = 0.0;
        return;
    }
    for (size_t i = 0; i < walk.count; i++) {
        const struct object_piece *piece = &walk.pieces[i];
        struct still_media media = still_media(still, piece->region);
        double passed = i + 1 < walk.count ? passed_share(still, ray, piece, walk.pieces[i + 1].region) : 1.0;
        struct transmittance_accuracy own_accuracy = {accuracy->optical_depth / (double)walk.count,
                                                      accuracy->light / (double)walk.count};
        double own[3];

        transmittance_within(media.list, media.count, ray, piece->begin, piece->end, &own_accuracy, own);
        for (int c = 0; c < 3; c++)
            share[c] *= own[c] * passed;
    }
}
