// SPDX-License-Identifier: Apache-2.0
#include "reference/path_aim.h"

#include "reference/phase_draw.h"

#include <math.h>

// Set by noise at equal time, and so is how fast chances fall, and where they are nothing: in mean free paths beyond
// those that second paths go.
static const double LEAST_CHANCE = 0.1, FALL = 2.0, DEEPEST = 16.0;
// Of a depth that is known roughly: gaps between the cells let light through.
static const double ROUGH_SHARE = 0.5;

size_t path_aim_count_lamps(const struct path_scene *scene)
{
    return scene->still->light_count + scene->still->sphere_count;
}

// Towards a lamp, as the vertex sees it: m to it, 0: it lies there itself.
static double find_way(const struct path_scene *scene, const struct path_vertex *vertex, size_t lamp, struct vec3 *way)
{
    const struct still *still = scene->still;
    double distance;

    if (lamp < still->light_count) {
        struct light_arrival arrival = light_arrive(&still->lights[lamp], vertex->position);

        *way = vec3_scale(arrival.travel, -1.0);
        return arrival.distance;
    }
    *way = vec3_subtract(still->spheres[lamp - still->light_count].center, vertex->position);
    distance = vec3_length(*way);
    *way = vec3_scale(*way, 1.0 / distance);
    return distance;
}

// Of all media on the way; roughly where they vary.
static double find_depth(const struct path_scene *scene, const struct ray *way, double distance, size_t lamp)
{
    double depth = ROUGH_SHARE * path_depth_at(&scene->depth, lamp, way->origin);

    for (size_t i = 0; i < scene->medium_count; i++) {
        const struct density *density = &scene->media[i].medium->density;

        if (scene->media[i].majorant.is_even)
            depth += scene->media[i].sigma * density->column(density->field, way, 0.0, distance);
    }
    return depth;
}

// A vertex that turns more easily to where second paths go sends more: to the lamp, and where media scatter backward,
// away from it.
static double find_chance(const struct path_vertex *vertex, struct vec3 way, double depth)
{
    struct vec3 on = vertex->turn > 1.0 ? vec3_scale(way, -1.0) : way;
    double beyond = depth - vertex->aim_vertices, fallen = beyond > 0.0 ? exp(-beyond / FALL) : 1.0;

    if (beyond > DEEPEST) return 0.0;
    return fallen * fmin(fmax(4.0 * M_PI * path_vertex_scatter(vertex, on), LEAST_CHANCE), 1.0);
}

void path_aim_look(struct path_aim *aim, const struct path_scene *scene, const struct path_vertex *vertex)
{
    if (vertex->aim_vertices == 0) return;
    aim->lamp_count = path_aim_count_lamps(scene);
    for (size_t i = 0; i < aim->lamp_count; i++) {
        struct ray way = {.origin = vertex->position};
        double distance = find_way(scene, vertex, i, &way.direction);

        aim->ways[i] = way.direction;
        aim->chances[i] =
            distance > 0.0 ? find_chance(vertex, way.direction, find_depth(scene, &way, distance, i)) : 0.0;
    }
}

struct vec3 path_aim_draw(const struct path_aim *aim, const struct path_vertex *vertex, size_t lamp,
                          struct stream *stream)
{
    return phase_draw_about(aim->ways[lamp], phase_draw_cosine(vertex->medium, stream), stream);
}

// What vertices noted so long ago that their second paths have ended is forgotten.
static void forget(struct path_aim *aim)
{
    for (int i = 0; i < PATH_AIM_VERTICES; i++) {
        if (aim->left[i] == 0 || --aim->left[i] > 0) continue;
        for (size_t k = 0; k < aim->lamp_count; k++)
            aim->ratios[i][k] = 0.0;
    }
}

void path_aim_note(struct path_aim *aim, const struct path_vertex *vertex, struct vec3 direction)
{
    double scatter;

    if (aim->lamp_count > 0) forget(aim);
    if (vertex->aim_vertices == 0) return;
    scatter = path_vertex_scatter(vertex, direction);
    aim->next = (aim->next + 1) % PATH_AIM_VERTICES;
    aim->left[aim->next] = vertex->aim_vertices;
    for (size_t i = 0; i < aim->lamp_count; i++) {
        double chance = aim->chances[i];

        aim->ratios[aim->next][i] =
            chance > 0.0 ? chance * medium_phase(vertex->medium, vec3_dot(aim->ways[i], direction)) / scatter : 0.0;
    }
}
