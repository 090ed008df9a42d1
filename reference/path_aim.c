// SPDX-License-Identifier: Apache-2.0
#include "reference/path_aim.h"

#include "reference/phase_draw.h"

#include <math.h>

// Set by noise at equal time.
static const double LEAST_CHANCE = 0.1;

size_t path_aim_count_lamps(const struct path_scene *scene)
{
    return scene->still->light_count + scene->still->sphere_count;
}

// Towards a lamp, as the vertex sees it; false: it lies there itself.
static bool find_way(const struct path_scene *scene, const struct path_vertex *vertex, size_t lamp, struct vec3 *way)
{
    const struct still *still = scene->still;
    double distance;

    if (lamp < still->light_count) {
        struct light_arrival arrival = light_arrive(&still->lights[lamp], vertex->position);

        *way = vec3_scale(arrival.travel, -1.0);
        return arrival.distance > 0.0;
    }
    *way = vec3_subtract(still->spheres[lamp - still->light_count].center, vertex->position);
    distance = vec3_length(*way);
    *way = vec3_scale(*way, 1.0 / distance);
    return distance > 0.0;
}

// A vertex that turns to the lamp more easily sends more.
static double find_chance(const struct path_vertex *vertex, struct vec3 way)
{
    return fmin(fmax(4.0 * M_PI * path_vertex_scatter(vertex, way), LEAST_CHANCE), 1.0);
}

double path_aim_chance(const struct path_scene *scene, const struct path_vertex *vertex, size_t lamp)
{
    struct vec3 way;

    if (vertex->aim_vertices == 0 || !find_way(scene, vertex, lamp, &way)) return 0.0;
    return find_chance(vertex, way);
}

struct vec3 path_aim_draw(const struct path_scene *scene, const struct path_vertex *vertex, size_t lamp,
                          struct stream *stream)
{
    struct vec3 way;

    (void)find_way(scene, vertex, lamp, &way);
    return phase_draw_about(way, phase_draw_cosine(vertex->medium, stream), stream);
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

void path_aim_note(struct path_aim *aim, const struct path_scene *scene, const struct path_vertex *vertex,
                   struct vec3 direction)
{
    double scatter;

    if (aim->lamp_count > 0) forget(aim);
    if (vertex->aim_vertices == 0) return;
    scatter = path_vertex_scatter(vertex, direction);
    aim->lamp_count = path_aim_count_lamps(scene);
    aim->next = (aim->next + 1) % PATH_AIM_VERTICES;
    aim->left[aim->next] = vertex->aim_vertices;
    for (size_t i = 0; i < aim->lamp_count; i++) {
        double *ratio = &aim->ratios[aim->next][i];
        struct vec3 way;

        *ratio = 0.0;
        if (find_way(scene, vertex, i, &way))
            *ratio = find_chance(vertex, way) * medium_phase(vertex->medium, vec3_dot(way, direction)) / scatter;
    }
}
