// SPDX-License-Identifier: Apache-2.0
#include "reference/path_passage.h"

#include <math.h>

// Below this share of the light a passage goes on at random.
static const double WEAK_SHARE = 0.1;

static double greatest(const double value[static 3])
{
    return fmax(fmax(value[0], value[1]), value[2]);
}

static bool is_blocked(const struct still *still, const struct ray *ray, double distance)
{
    struct object_walk walk;

    if (still->objects.count == 0) return false;
    objects_walk(&still->objects, ray, distance, &walk);
    for (size_t i = 0; i < walk.count; i++)
        if (objects_is_opaque(&still->objects, walk.pieces[i].region)) return true;
    return false;
}

static void pass_even(const struct medium *medium, const struct ray *ray, double distance, double light[static 3])
{
    double column = medium->density.column(medium->density.field, ray, 0.0, distance);

    for (int c = 0; c < 3; c++) {
        double sigma_t = medium->sigma_s[c] + medium->sigma_a[c];

        // The column may be infinite, but a coefficient of 0 still attenuates nothing.
        if (sigma_t > 0.0) light[c] *= exp(-sigma_t * column);
    }
}

// False when nothing is left.
static bool survives(struct stream *stream, double full, double light[static 3])
{
    double left = greatest(light), chance = left / (WEAK_SHARE * full);

    if (!(left > 0.0)) return false;
    if (chance >= 1.0) return true;
    if (stream_draw(stream) >= chance) {
        light[0] = light[1] = light[2] = 0.0;
        return false;
    }
    for (int c = 0; c < 3; c++)
        light[c] /= chance;
    return true;
}

static void pass_varied(const struct path_medium *path_medium, const struct ray *ray, double distance,
                        struct stream *stream, double light[static 3])
{
    const struct medium *medium = path_medium->medium;
    double full = greatest(light);
    struct flight flight;

    flight_begin(&flight, &path_medium->majorant, ray, 0.0, distance);
    for (;;) {
        double at = flight_advance(&flight, -log(1.0 - stream_draw(stream)) / path_medium->sigma), density;

        if (isinf(at)) return;
        density = medium->density.at(medium->density.field, ray_at(ray, at));
        if (density == 0.0) continue;
        for (int c = 0; c < 3; c++) {
            double share = (medium->sigma_s[c] + medium->sigma_a[c]) * density / (path_medium->sigma * flight.most);

            light[c] *= fmax(1.0 - share, 0.0);
        }
        if (!survives(stream, full, light)) return;
    }
}

void path_passage_attenuate(const struct path_scene *scene, const struct ray *ray, double distance,
                            struct stream *stream, double light[static 3])
{
    if (is_blocked(scene->still, ray, distance)) {
        light[0] = light[1] = light[2] = 0.0;
        return;
    }
    for (size_t i = 0; i < scene->medium_count && greatest(light) > 0.0; i++) {
        const struct path_medium *medium = &scene->media[i];

        if (medium->majorant.is_even) {
            pass_even(medium->medium, ray, distance, light);
        } else {
            pass_varied(medium, ray, distance, stream, light);
        }
    }
}
