// SPDX-License-Identifier: Apache-2.0
#include "reference/paths.h"

#include "core/base/alloc.h"
#include "reference/path_walk.h"
#include "reference/transmittance.h"

#include <math.h>
#include <stdlib.h>

// Of the light from behind everything.
static const double BEHIND_RELATIVE = 1e-6;

struct paths {
    struct path_scene scene;
};

struct paths *paths_create(const struct still *still, int orders, struct error *error)
{
    struct paths *paths;

    if (!path_scene_is_possible(still, error)) return NULL;
    paths = xcalloc(1, sizeof *paths);
    path_scene_init(&paths->scene, still, orders);
    return paths;
}

void paths_destroy(struct paths *paths)
{
    if (!paths) return;
    path_scene_finish(&paths->scene);
    free(paths);
}

// What lies behind everything, through the media before it.
static void find_behind(const struct still *still, const struct ray *ray, double behind[static 3])
{
    const struct camera_pinhole *camera = &still->camera;
    bool shows_dome = still->has_dome && still->dome.is_visible;
    struct still_media media = still_media(still, 0);
    double share[3], light[3] = {0.0, 0.0, 0.0};
    struct object_walk walk;

    behind[0] = behind[1] = behind[2] = 0.0;
    if (!shows_dome && !still->has_background) return;
    objects_walk(&still->objects, ray, INFINITY, &walk);
    if (walk.count > 1 || walk.pieces[0].region > 0) return;
    if (shows_dome) dome_radiance(&still->dome, ray->direction, light);
    transmittance(media.list, media.count, ray, camera->clip_near, camera->clip_far, BEHIND_RELATIVE, share);
    for (int c = 0; c < 3; c++)
        behind[c] = (light[c] + (still->has_background ? still->background[c] : 0.0)) * share[c];
}

static struct path_walk walk_through(const struct paths *paths, double x, double y)
{
    const struct camera_pinhole *camera = &paths->scene.still->camera;
    struct path_walk walk = {
        .ray = camera_pinhole_ray(camera, x, y), .near = camera->clip_near, .far = camera->clip_far, .is_seen = true};

    path_walk_force(&paths->scene, &walk);
    return walk;
}

void paths_measure_point(const struct paths *paths, double x, double y, long count, uint64_t seed,
                         struct paths_light *light)
{
    const struct still *still = paths->scene.still;
    struct path_walk walk = walk_through(paths, x, y);
    double squares[3] = {0.0, 0.0, 0.0}, behind[3];

    *light = (struct paths_light){0};
    for (long i = 0; i < count; i++) {
        struct stream stream = stream_of(seed, (uint64_t)i);
        double radiance[3] = {0.0, 0.0, 0.0};

        light->looks += (double)path_walk_add(&paths->scene, &walk, &stream, radiance);
        for (int c = 0; c < 3; c++) {
            double off = radiance[c] - light->mean[c];

            // The mean and the sum of squares about it: Welford, Technometrics 4, 1962.
            light->mean[c] += off / (double)(i + 1);
            squares[c] += off * (radiance[c] - light->mean[c]);
        }
    }
    find_behind(still, &walk.ray, behind);
    for (int c = 0; c < 3; c++) {
        light->mean[c] += behind[c];
        if (count > 1) light->error[c] = sqrt(squares[c] / ((double)count * (double)(count - 1)));
    }
}

bool paths_measure_parts(const struct paths *paths, const struct paths_parts_params *params, struct paths_parts *parts)
{
    struct path_walk walk = walk_through(paths, params->x, params->y);
    double most = params->draws_most > 0.0 ? params->draws_most : INFINITY, behind[3];

    *parts = (struct paths_parts){0};
    walk.beyond = parts->beyond;
    walk.parted = params->modelled;
    for (long i = 0; i < params->count; i++) {
        struct stream stream = stream_of(params->seed, (uint64_t)i);

        if (isfinite(most)) walk.draws_most = (uint64_t)fmax(most - parts->draws, 1.0);
        (void)path_walk_add(&paths->scene, &walk, &stream, parts->within);
        parts->draws += (double)stream.drawn;
        if (parts->draws > most) return false;
    }
    find_behind(paths->scene.still, &walk.ray, behind);
    for (int c = 0; c < 3; c++) {
        parts->within[c] = parts->within[c] / (double)params->count + behind[c];
        parts->beyond[c] /= (double)params->count;
    }
    return true;
}

bool paths_measure_pixel(const struct still *still, int orders, int x, int y, long count, uint64_t seed,
                         struct paths_light *light)
{
    struct paths *paths = paths_create(still, orders, NULL);

    if (!paths) return false;
    paths_measure_point(paths, x + 0.5, y + 0.5, count, seed, light);
    paths_destroy(paths);
    return true;
}
